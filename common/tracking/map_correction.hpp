#pragma once

#include <span>
#include <vector>

#include "common/egraph/types.hpp"
#include "common/tracking/map.hpp"

namespace eg::tracking {

/// A keyframe that the refinement of the whole graph wants elsewhere.
struct KeyframeCorrection {
  KeyframeId keyframe;
  geometry::Pose announced;  ///< world_from_camera that the refinement started from
  geometry::Pose refined;    ///< and where it ended
};

/// What the corrections come to in a map that may have gone on since: a keyframe that local bundle adjustment has moved
/// meanwhile takes the same step from where it is now, and those that are younger than all the corrections go along
/// with the newest that was corrected, against which they were measured. `newest`: the youngest keyframe that the
/// refinement knew. Returns new poses, oldest first.
std::vector<egraph::CorrectedPose> corrected_poses(const Map& map, std::span<const KeyframeCorrection> corrections,
                                                   KeyframeId newest);

/// Moves keyframes, and points, lines and planes with them: each to the mean of where the keyframes that saw it would
/// take it. Covariances stay: corrections are fractions of a degree.
void move_with_keyframes(std::span<const egraph::CorrectedPose> keyframes, Map& map);

}  // namespace eg::tracking
