#include "common/tracking/keyframe_policy.hpp"

#include <algorithm>

namespace eg::tracking {

bool KeyframePolicy::wants_keyframe(int tracked, bool sees_new_structure) {
  ++frames_since_;
  best_tracked_ = std::max(best_tracked_, tracked);
  new_structure_run_ = sees_new_structure ? new_structure_run_ + 1 : 0;
  if (frames_since_ < options_.min_frames) return false;
  const double min_ratio =
      best_tracked_ < options_.many_features ? options_.min_tracked_ratio : options_.min_tracked_ratio_of_many;
  return frames_since_ >= options_.max_frames || tracked < min_ratio * best_tracked_ ||
         new_structure_run_ >= options_.new_structure_frames;
}

void KeyframePolicy::keyframe_added() {
  frames_since_ = 0;
  best_tracked_ = 0;
  new_structure_run_ = 0;
}

}  // namespace eg::tracking
