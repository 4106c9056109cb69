#pragma once

#include <vector>

#include "common/egraph/types.hpp"
#include "common/tracking/map.hpp"

namespace eg::tracking {

/// What the pose of keyframe `id`, measured against the map with `covariance` (world frame, left perturbation), says
/// about where it stands relative to older keyframes that saw the same features. The map around it was made by those
/// keyframes, each as much as it shares; so they share the pose's information by their numbers of features, and nothing
/// is counted twice. The covariance is to be that of the map's features alone: the graph counts directions by itself.
/// The `max_keyframes` that share the most are taken.
std::vector<egraph::RelativePose> relative_poses(const Map& map, KeyframeId id, const egraph::Matrix6d& covariance,
                                                 std::size_t max_keyframes = 6);

}  // namespace eg::tracking
