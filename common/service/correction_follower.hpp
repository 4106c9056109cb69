#pragma once

#include <cstdint>
#include <optional>

#include "common/tracking/pose_estimate.hpp"

namespace eg::service {

/// Sees to it that a receiver of POSE_CORRECTION ends up with every correction. Each says from which version to which
/// it leads, and each POSE says which version is the newest; what is missing in between is asked for by RESEND. Entries
/// may be applied in any order as long as the latest version of each keyframe wins.
class CorrectionFollower {
 public:
  /// False: nothing new in it.
  bool take(const tracking::PoseCorrection& correction);

  /// There are corrections up to `version`.
  void announce(std::int64_t version);

  /// Whether every correction up to `version` is there.
  [[nodiscard]] bool has(std::int64_t version) const { return complete_ >= version; }

  /// The version to ask from, if some after it have been missing for a while; at most once per period. `now_utime`:
  /// monotonic, microseconds.
  std::optional<std::int64_t> to_request(std::int64_t now_utime);

 private:
  std::int64_t complete_ = 0;   ///< every correction up to this version is there
  std::int64_t announced_ = 0;  ///< the newest that was heard of
  std::int64_t last_request_ = 0;
};

}  // namespace eg::service
