#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "common/tracking/pose_estimate.hpp"

namespace eg::services {

/// Real time: the keyframes that the map still lacks. Each needs its POSE message and what goes with it, images and
/// features; what does not come by itself is asked for, again and again, until it is there or so old that nobody can
/// have it any more.
class KeyframeQueue {
 public:
  /// What to ask the others to send again.
  struct Missing {
    std::vector<std::int64_t> poses;            ///< keyframe ids
    std::vector<tracking::PoseEstimate> parts;  ///< poses of keyframes that lack something else
  };

  /// Keyframe `id` and all before it are in the map already, from an earlier session.
  void begin_behind(egraph::KeyframeId id) { announced_ = id.value; }

  /// There is such a keyframe, and hence all before it.
  void announce(egraph::KeyframeId id);

  /// A keyframe's pose has come. False: that keyframe is done already.
  bool add_pose(const tracking::PoseEstimate& pose);

  /// The pose that waits for other parts of a frame; null if none does.
  [[nodiscard]] const tracking::PoseEstimate* waiting_for(std::int64_t sequence) const;

  /// The keyframe is in the map, or will never be.
  void finish(egraph::KeyframeId id);

  /// What has been missing for a while, at most once per period. `now_utime`: monotonic, microseconds.
  Missing to_request(std::int64_t now_utime);

  /// Keyframes that were given up.
  [[nodiscard]] std::int64_t given_up() const { return given_up_; }

 private:
  struct Entry {
    std::optional<tracking::PoseEstimate> pose;
    int requests = 0;
  };

  std::map<std::int32_t, Entry> open_;  ///< by keyframe id
  std::int32_t announced_ = -1;         ///< all up to here are open or done
  std::int64_t last_request_ = 0;
  std::int64_t given_up_ = 0;
};

}  // namespace eg::services
