#include "services/viewer/direction_colours.hpp"

#include <cmath>

namespace eg::services {
namespace {

/// Directions nearer than 8 degrees have one colour: more than the few degrees that separate a plane's normal from
/// lines measured along it, less than what an eye takes for two directions.
const double kSameDirection = std::cos(0.14);

}  // namespace

DirectionColours::DirectionColours(std::span<const egraph::DirectionLandmark> landmarks) {
  for (const egraph::DirectionLandmark& landmark : landmarks) {
    // Single lines come and go; they take a colour but do not make one.
    if (landmark.kind == egraph::DirectionKind::potential_direction) continue;
    if (of(landmark.direction) == kNone) directions_.push_back(landmark.direction);
  }
}

std::int32_t DirectionColours::of(const Eigen::Vector3d& direction) const {
  std::int32_t nearest = kNone;
  double best = kSameDirection;
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    const double cosine = std::abs(directions_[i].dot(direction));
    if (cosine <= best) continue;
    best = cosine;
    nearest = static_cast<std::int32_t>(i);
  }
  return nearest;
}

}  // namespace eg::services
