#pragma once

#include <span>

#include "common/base/result.hpp"
#include "common/eval/alignment.hpp"
#include "common/eval/statistics.hpp"
#include "common/geometry/pose.hpp"

namespace eg::eval {

struct TrajectoryErrorOptions {
  double max_time_difference_s = 0.02;  ///< between an estimated and a reference pose
  double rpe_interval_s = 1.0;          ///< relative errors are taken over this time
  double max_gap_s = 0.2;               ///< matched poses further apart than this leave a hole in the coverage
};

/// How far an estimated trajectory is from the true one (Sturm, Engelhard, Endres, Burgard, Cremers, IROS 2012, section
/// IV).
struct TrajectoryErrors {
  std::size_t estimated_poses = 0;
  std::size_t reference_poses = 0;
  std::size_t matched_poses = 0;
  double coverage =
      0.0;  ///< share, in [0, 1], of the reference's time span between matched poses less than a gap apart

  ErrorStatistics ate_m;               ///< camera positions after the best rigid alignment
  ErrorStatistics are_aligned_deg;     ///< orientations after the best constant rotation (align_rotations)
  ErrorStatistics are_first_pose_deg;  ///< orientations after making the first matched pair equal
  ErrorStatistics rpe_translation_m;   ///< motion over rpe_interval_s; count 0 if the trajectory is shorter
  ErrorStatistics rpe_rotation_deg;
};

/// Both trajectories in strictly increasing time. Fails if fewer than two poses match in time.
base::Result<TrajectoryErrors> evaluate_trajectory(std::span<const geometry::StampedPose> estimate,
                                                   std::span<const geometry::StampedPose> reference,
                                                   const TrajectoryErrorOptions& options = {});

}  // namespace eg::eval
