#include "common/eval/drift.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "common/eval/alignment.hpp"
#include "common/geometry/so3.hpp"

namespace eg::eval {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

struct Line {
  double slope = 0.0;
  double slope_sigma = 0.0;
};

/// Least squares through (0, y_0), (step, y_1), ...
Line fit_line(const std::vector<double>& values, double step) {
  const auto n = static_cast<double>(values.size());
  const double mean_x = 0.5 * (n - 1.0) * step;
  double mean_y = 0.0;
  for (const double value : values) mean_y += value / n;
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = static_cast<double>(i) * step - mean_x;
    xx += x * x;
    xy += x * (values[i] - mean_y);
  }
  Line line{xy / xx, 0.0};
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double residual = values[i] - mean_y - line.slope * (static_cast<double>(i) * step - mean_x);
    squares += residual * residual;
  }
  line.slope_sigma = std::sqrt(squares / (n - 2.0) / xx);
  return line;
}

void measure_rotation(std::span<const PosePair> pairs, const DriftOptions& options, Drift& drift) {
  const PosePair& first = pairs.front();
  const Eigen::Matrix3d reference_from_estimate = first.reference.rotation * first.estimate.rotation.transpose();
  const auto blocks = static_cast<std::size_t>(options.blocks);
  std::vector<double> sums(blocks, 0.0);
  std::vector<double> counts(blocks, 0.0);
  for (const PosePair& pair : pairs) {
    const double share = (pair.time_s - first.time_s) / drift.duration_s;
    const std::size_t block = std::min(blocks - 1, static_cast<std::size_t>(share * static_cast<double>(blocks)));
    sums[block] += kDegreesPerRadian * geometry::rotation_angle_between(
                                           reference_from_estimate * pair.estimate.rotation, pair.reference.rotation);
    counts[block] += 1.0;
  }
  std::vector<double> means;
  // A block without poses (the camera was lost) says what the one before said.
  for (std::size_t i = 0; i < blocks; ++i) means.push_back(counts[i] > 0.0 ? sums[i] / counts[i] : means.back());
  const Line line = fit_line(means, drift.duration_s / 60.0 / options.blocks);
  drift.rotation_slope_deg_per_min = line.slope;
  drift.rotation_slope_sigma = line.slope_sigma;
  drift.rotation_start_deg = means.front();
  drift.rotation_end_deg = means.back();
}

/// True length of the way to every pair.
std::vector<double> path_lengths(std::span<const PosePair> pairs) {
  std::vector<double> lengths = {0.0};
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    lengths.push_back(lengths.back() + (pairs[i].reference.translation - pairs[i - 1].reference.translation).norm());
  }
  return lengths;
}

void measure_segments(std::span<const PosePair> pairs, const std::vector<double>& lengths, const DriftOptions& options,
                      Drift& drift) {
  std::vector<double> position, rotation;
  std::size_t end = 0;
  double next_start = 0.0;
  for (std::size_t start = 0; start < pairs.size(); ++start) {
    if (lengths[start] < next_start) continue;
    next_start = lengths[start] + options.segment_step_m;
    while (end < pairs.size() && lengths[end] - lengths[start] < options.segment_m) ++end;
    if (end == pairs.size()) break;
    const double length = lengths[end] - lengths[start];
    const geometry::Pose true_motion = pairs[start].reference.inverse() * pairs[end].reference;
    const geometry::Pose error = true_motion.inverse() * (pairs[start].estimate.inverse() * pairs[end].estimate);
    position.push_back(error.translation.norm() / length);
    rotation.push_back(kDegreesPerRadian * geometry::so3_log(error.rotation).norm() / length);
  }
  drift.position_per_m = statistics_of(position);
  drift.rotation_deg_per_m = statistics_of(rotation);
}

}  // namespace

base::Result<Drift> evaluate_drift(std::span<const geometry::StampedPose> estimate,
                                   std::span<const geometry::StampedPose> reference, const DriftOptions& options) {
  const std::vector<PosePair> pairs = match_by_time(estimate, reference, options.max_time_difference_s);
  if (pairs.size() < static_cast<std::size_t>(options.blocks)) {
    return base::fail("only " + std::to_string(pairs.size()) + " of " + std::to_string(estimate.size()) +
                      " estimated poses have a reference pose; at least " + std::to_string(options.blocks) +
                      " are needed");
  }
  Drift drift;
  drift.duration_s = pairs.back().time_s - pairs.front().time_s;
  const std::vector<double> lengths = path_lengths(pairs);
  drift.path_m = lengths.back();
  measure_rotation(pairs, options, drift);
  measure_segments(pairs, lengths, options, drift);
  const geometry::Pose true_motion = pairs.front().reference.inverse() * pairs.back().reference;
  const geometry::Pose estimated_motion = pairs.front().estimate.inverse() * pairs.back().estimate;
  drift.end_error_m = (true_motion.translation - estimated_motion.translation).norm();
  return drift;
}

}  // namespace eg::eval
