#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
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
  /// What the files say of a frame: 16 MB an hour at 30 Hz.
  struct Row {
    std::int64_t sequence = 0;
    std::int64_t utime = 0;
    tracking::TrackingState state = tracking::TrackingState::initialising;
    std::uint32_t reason = 0;  ///< index into reasons_
    tracking::KeyframeId keyframe;
    tracking::KeyframeId rotation_reference;
    std::int32_t points = 0;
    std::int32_t lines = 0;
    std::int32_t planes = 0;
    std::int32_t directions = 0;
    tracking::KeyframeId reference;  ///< invalid: the frame has no pose
    geometry::Pose reference_from_camera;
  };
  static_assert(sizeof(Row) <= 152, "one is kept of every frame");

  /// Frames have few different reasons: each is kept once.
  std::uint32_t number_of(const std::string& reason);
  [[nodiscard]] std::string state_row(const Row& row) const;

  [[nodiscard]] base::Status save_trajectory(const std::filesystem::path& path, const tracking::Map& map) const;
  [[nodiscard]] base::Status save_states(const std::filesystem::path& path) const;

  std::vector<Row> rows_;
  std::vector<std::string> reasons_;
  std::map<std::string, std::uint32_t> reason_numbers_;
  std::size_t earlier_keyframes_ = 0;
  std::int64_t frame_count_ = 0;  ///< of the whole stream; 0: not yet known
  std::vector<std::int64_t> skipped_utimes_;
};

}  // namespace eg::services
