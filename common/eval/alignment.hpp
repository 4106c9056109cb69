#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/geometry/pose.hpp"

namespace eg::eval {

/// An estimated pose and the true one of the same moment, each camera to its own world.
struct PosePair {
  double time_s = 0.0;  ///< of the estimate
  geometry::Pose estimate;
  geometry::Pose reference;
};

/// Gives each estimate the reference pose nearest in time (the earlier of equals) if it is at most `max_difference_s`
/// away. Both series are in increasing time; one reference pose may serve several estimates.
std::vector<PosePair> match_by_time(std::span<const geometry::StampedPose> estimate,
                                    std::span<const geometry::StampedPose> reference, double max_difference_s);

/// The rigid transform reference_from_estimate without scale that brings the camera positions together:
/// argmin sum |t_ref - T t_est|² (Horn, JOSA A 1987; solved by SVD as in Umeyama, PAMI 1991, equations 40 to 42). Never
/// a reflection: a mirrored trajectory does not align. Needs at least one pair.
geometry::Pose align_positions(std::span<const PosePair> pairs);

/// The constant rotation from the left, reference_from_estimate, that brings the orientations together: the chordal
/// mean argmin sum |R_ref - R R_est|_F² (Hartley, Trumpf, Dai, Li, IJCV 2013, section 5). Needs at least one pair.
Eigen::Matrix3d align_rotations(std::span<const PosePair> pairs);

}  // namespace eg::eval
