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

  /// Frames that the source could not read.
  void set_skipped(std::vector<std::int64_t> utimes) { skipped_utimes_ = std::move(utimes); }

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
  std::vector<std::int64_t> skipped_utimes_;
};

}  // namespace eg::services
