#pragma once

#include <span>

#include "common/base/result.hpp"
#include "common/eval/statistics.hpp"
#include "common/geometry/pose.hpp"

namespace eg::eval {

struct DriftOptions {
  double max_time_difference_s = 0.02;  ///< between an estimated and a reference pose
  double segment_m = 10.0;              ///< path length over which position drift is measured
  double segment_step_m = 1.0;          ///< between the starts of segments
  int blocks = 20;                      ///< of equal duration; errors within one are not independent
};

/// How errors grow with time and with the way gone.
struct Drift {
  double duration_s = 0.0;
  double path_m = 0.0;  ///< true length of the way between matched poses

  /// Rotation error against time, after aligning the first pose: least squares line through the means of the blocks.
  double rotation_slope_deg_per_min = 0.0;
  double rotation_slope_sigma = 0.0;  ///< standard error of that slope, from the blocks' scatter about the line
  double rotation_start_deg = 0.0;    ///< mean of the first block
  double rotation_end_deg = 0.0;      ///< mean of the last block

  /// Error of the motion over segments of the path, divided by their length (Geiger, Lenz, Urtasun, CVPR 2012). Count 0
  /// if the path is shorter than a segment.
  ErrorStatistics position_per_m;
  ErrorStatistics rotation_deg_per_m;
  double end_error_m = 0.0;  ///< position error of the last pose after aligning the first
};

/// Both trajectories in strictly increasing time. Fails if fewer poses match in time than there are blocks.
base::Result<Drift> evaluate_drift(std::span<const geometry::StampedPose> estimate,
                                   std::span<const geometry::StampedPose> reference, const DriftOptions& options = {});

}  // namespace eg::eval
