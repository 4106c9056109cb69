#include "common/tracking/keyframe_policy.hpp"

#include <algorithm>

#include "common/geometry/so3.hpp"

namespace eg::tracking {

bool KeyframePolicy::wants_keyframe(int tracked, bool sees_new_structure, const geometry::Pose& last_from_current) {
  ++frames_since_;
  best_tracked_ = std::max(best_tracked_, tracked);
  new_structure_run_ = sees_new_structure ? new_structure_run_ + 1 : 0;
  if (frames_since_ < options_.min_frames) return false;
  const bool has_moved = last_from_current.translation.norm() > options_.moved_translation ||
                         geometry::so3_log(last_from_current.rotation).norm() > options_.moved_rotation;
  return frames_since_ >= (has_moved ? options_.max_frames_moving : options_.max_frames) ||
         tracked < options_.min_tracked_ratio * best_tracked_ || new_structure_run_ >= options_.new_structure_frames;
}

void KeyframePolicy::keyframe_added() {
  frames_since_ = 0;
  best_tracked_ = 0;
  new_structure_run_ = 0;
}

}  // namespace eg::tracking
