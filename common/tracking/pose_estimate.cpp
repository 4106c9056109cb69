#include "common/tracking/pose_estimate.hpp"

namespace eg::tracking {

const char* to_string(TrackingState state) {
  switch (state) {
    case TrackingState::initialising:
      return "initialising";
    case TrackingState::tracking:
      return "tracking";
    case TrackingState::rotation_only:
      return "rotation_only";
    case TrackingState::lost:
      return "lost";
    case TrackingState::relocalised:
      return "relocalised";
  }
  return "unknown";
}

}  // namespace eg::tracking
