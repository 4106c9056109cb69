#include "common/eval/alignment.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/base/check.hpp"
#include "common/geometry/so3.hpp"

namespace eg::eval {
namespace {

using geometry::StampedPose;

const StampedPose& nearest_in_time(std::span<const StampedPose> series, double time_s) {
  const auto later = std::lower_bound(series.begin(), series.end(), time_s,
                                      [](const StampedPose& pose, double time) { return pose.time_s < time; });
  if (later == series.begin()) return *later;
  const auto earlier = std::prev(later);
  if (later == series.end()) return *earlier;
  return time_s - earlier->time_s <= later->time_s - time_s ? *earlier : *later;
}

}  // namespace

std::vector<PosePair> match_by_time(std::span<const StampedPose> estimate, std::span<const StampedPose> reference,
                                    double max_difference_s) {
  std::vector<PosePair> pairs;
  if (reference.empty()) return pairs;
  for (const auto& [time_s, pose] : estimate) {
    const StampedPose& nearest = nearest_in_time(reference, time_s);
    if (std::abs(nearest.time_s - time_s) <= max_difference_s)
      pairs.push_back({time_s, pose, nearest.world_from_camera});
  }
  return pairs;
}

geometry::Pose align_positions(std::span<const PosePair> pairs) {
  EG_CHECK(!pairs.empty(), "nothing to align");
  Eigen::Vector3d estimate_mean = Eigen::Vector3d::Zero(), reference_mean = Eigen::Vector3d::Zero();
  for (const PosePair& pair : pairs) {
    estimate_mean += pair.estimate.translation;
    reference_mean += pair.reference.translation;
  }
  estimate_mean /= static_cast<double>(pairs.size());
  reference_mean /= static_cast<double>(pairs.size());

  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const PosePair& pair : pairs) {
    covariance +=
        (pair.reference.translation - reference_mean) * (pair.estimate.translation - estimate_mean).transpose();
  }
  const Eigen::Matrix3d rotation = geometry::nearest_rotation(covariance);
  return {rotation, reference_mean - rotation * estimate_mean};
}

Eigen::Matrix3d align_rotations(std::span<const PosePair> pairs) {
  EG_CHECK(!pairs.empty(), "nothing to align");
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const PosePair& pair : pairs) sum += pair.reference.rotation * pair.estimate.rotation.transpose();
  return geometry::nearest_rotation(sum);
}

}  // namespace eg::eval
