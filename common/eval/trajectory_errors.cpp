#include "common/eval/trajectory_errors.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "common/geometry/so3.hpp"

namespace eg::eval {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
constexpr std::size_t kFewestPairs = 2;

ErrorStatistics position_errors(std::span<const PosePair> pairs) {
  const geometry::Pose reference_from_estimate = align_positions(pairs);
  std::vector<double> errors;
  for (const PosePair& pair : pairs) {
    errors.push_back((pair.reference.translation - reference_from_estimate * pair.estimate.translation).norm());
  }
  return statistics_of(errors);
}

ErrorStatistics rotation_errors(std::span<const PosePair> pairs, const Eigen::Matrix3d& reference_from_estimate) {
  std::vector<double> errors;
  for (const PosePair& pair : pairs) {
    errors.push_back(
        kDegreesPerRadian *
        geometry::rotation_angle_between(reference_from_estimate * pair.estimate.rotation, pair.reference.rotation));
  }
  return statistics_of(errors);
}

/// Compares the motion between every two pairs that are the interval apart, to within the tolerance.
void relative_errors(std::span<const PosePair> pairs, const TrajectoryErrorOptions& options, TrajectoryErrors& result) {
  std::vector<double> translation_m, rotation_deg;
  std::size_t end = 0;
  for (const PosePair& start : pairs) {
    const auto misfit = [&](std::size_t i) {
      return std::abs(pairs[i].time_s - start.time_s - options.rpe_interval_s);
    };
    while (end + 1 < pairs.size() && misfit(end + 1) < misfit(end)) ++end;
    if (misfit(end) > options.max_time_difference_s) continue;
    const geometry::Pose estimated_motion = start.estimate.inverse() * pairs[end].estimate;
    const geometry::Pose true_motion = start.reference.inverse() * pairs[end].reference;
    const geometry::Pose error = true_motion.inverse() * estimated_motion;
    translation_m.push_back(error.translation.norm());
    rotation_deg.push_back(kDegreesPerRadian * geometry::so3_log(error.rotation).norm());
  }
  result.rpe_translation_m = statistics_of(translation_m);
  result.rpe_rotation_deg = statistics_of(rotation_deg);
}

double coverage_of(std::span<const PosePair> pairs, std::span<const geometry::StampedPose> reference,
                   double max_gap_s) {
  double covered = 0.0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    const double step = pairs[i].time_s - pairs[i - 1].time_s;
    if (step <= max_gap_s) covered += step;
  }
  const double span = reference.back().time_s - reference.front().time_s;
  return span > 0.0 ? std::min(covered / span, 1.0) : 0.0;
}

}  // namespace

base::Result<TrajectoryErrors> evaluate_trajectory(std::span<const geometry::StampedPose> estimate,
                                                   std::span<const geometry::StampedPose> reference,
                                                   const TrajectoryErrorOptions& options) {
  const std::vector<PosePair> pairs = match_by_time(estimate, reference, options.max_time_difference_s);
  if (pairs.size() < kFewestPairs) {
    return base::fail("only " + std::to_string(pairs.size()) + " of " + std::to_string(estimate.size()) +
                      " estimated poses have a reference pose within " +
                      std::to_string(std::lround(1e3 * options.max_time_difference_s)) + " ms; at least 2 are needed");
  }
  TrajectoryErrors result;
  result.estimated_poses = estimate.size();
  result.reference_poses = reference.size();
  result.matched_poses = pairs.size();
  result.coverage = coverage_of(pairs, reference, options.max_gap_s);
  result.ate_m = position_errors(pairs);
  result.are_aligned_deg = rotation_errors(pairs, align_rotations(pairs));
  const PosePair& first = pairs.front();
  result.are_first_pose_deg = rotation_errors(pairs, first.reference.rotation * first.estimate.rotation.transpose());
  relative_errors(pairs, options, result);
  return result;
}

}  // namespace eg::eval
