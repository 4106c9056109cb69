#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "common/base/result.hpp"
#include "common/tracking/map.hpp"
#include "common/tracking/pose_estimate.hpp"

namespace eg::services {

/// What the tracker said about every frame, and the files made of it.
class TrackRecord {
 public:
  /// The frame's pose is kept relative to the map's newest keyframe, so that a later correction takes the frame along.
  void add(const tracking::PoseEstimate& estimate, const tracking::Map& map);

  [[nodiscard]] bool empty() const { return rows_.empty(); }
  [[nodiscard]] std::int64_t frame_count() const { return frame_count_; }

  /// So many keyframes of the map are an earlier session's, with times of their own: keyframes.txt is without them.
  void set_earlier_keyframes(std::size_t count) { earlier_keyframes_ = count; }

  /// What the source sent, and the frames that it could not read.
  void set_end(std::int64_t frame_count, std::vector<std::int64_t> skipped_utimes) {
    frame_count_ = frame_count;
    skipped_utimes_ = std::move(skipped_utimes);
  }

  base::Status save(const std::filesystem::path& folder, const tracking::Map& map) const;

 private:
  struct Row {
    tracking::PoseEstimate estimate;
    tracking::KeyframeId reference;
    geometry::Pose reference_from_camera;
  };

  [[nodiscard]] base::Status save_trajectory(const std::filesystem::path& path, const tracking::Map& map) const;
  [[nodiscard]] base::Status save_states(const std::filesystem::path& path) const;

  std::vector<Row> rows_;
  std::size_t earlier_keyframes_ = 0;
  std::int64_t frame_count_ = 0;  ///< of the whole stream; 0: not yet known
  std::vector<std::int64_t> skipped_utimes_;
};

}  // namespace eg::services
