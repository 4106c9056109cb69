#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "common/tracking/pose_estimate.hpp"

namespace eg::services {

/// Numbers the corrections of keyframes' poses and remembers the latest of each keyframe, so that whoever missed some
/// gets what is still in force of them.
class CorrectionRecord {
 public:
  /// @param entries_per_message so that messages stay below 180 kB
  explicit CorrectionRecord(std::size_t entries_per_message = 1500) : entries_per_message_(entries_per_message) {}

  /// What to announce; nothing if there are no entries.
  std::vector<tracking::PoseCorrection> add(std::int64_t session, std::vector<tracking::PoseCorrection::Entry> entries);

  /// Everything that was moved after `version`, by its latest pose. Nothing if there is nothing newer.
  [[nodiscard]] std::vector<tracking::PoseCorrection> since(std::int64_t version) const;

  /// Of the newest correction; 0: there was none.
  [[nodiscard]] std::int64_t version() const { return version_; }

 private:
  struct Latest {
    std::int64_t version = 0;
    geometry::Pose world_from_camera;
  };

  std::size_t entries_per_message_;
  std::int64_t session_ = 0;
  std::int64_t version_ = 0;
  std::map<egraph::KeyframeId, Latest> latest_;
};

}  // namespace eg::services
