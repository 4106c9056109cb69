#include "tests/support/slam_loop.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "common/base/check.hpp"
#include "common/geometry/so3.hpp"

namespace eg::test {

tracking::PoseEstimate SlamLoop::step(const features::FrameFeatures& frame) {
  tracking::TrackResult result = tracker_.track(frame);
  if (result.keyframe) {
    const auto update = builder_.add_keyframe(*result.keyframe);
    EG_CHECK(update.has_value(), "the tracker announces keyframes in order");
    const auto corrected = tracker_.follow(*update);
    EG_CHECK(corrected.has_value(), "the replica has every update");
    corrections_ += static_cast<int>(corrected->size());
    keyframes_.push_back(std::move(*result.keyframe));
  }
  estimates_.push_back(result.estimate);
  return result.estimate;
}

LoopErrors errors(const std::vector<tracking::PoseEstimate>& estimates, const FeatureSequence& truth) {
  LoopErrors found;
  for (const tracking::PoseEstimate& estimate : estimates) {
    if (!estimate.has_pose) continue;
    const geometry::Pose& expected = truth.world_from_camera[static_cast<std::size_t>(estimate.header.sequence)];
    const double rotation = geometry::rotation_angle_between(estimate.world_from_camera.rotation, expected.rotation);
    const double translation = (estimate.world_from_camera.translation - expected.translation).norm();
    ++found.poses;
    found.worst_rotation = std::max(found.worst_rotation, rotation);
    found.worst_translation = std::max(found.worst_translation, translation);
    found.mean_rotation += rotation;
    found.mean_translation += translation;
  }
  found.mean_rotation /= std::max(1, found.poses);
  found.mean_translation /= std::max(1, found.poses);
  return found;
}

bool is_sound(const tracking::PoseEstimate& estimate) {
  const geometry::Pose& pose = estimate.world_from_camera;
  const egraph::Matrix6d& covariance = estimate.covariance;
  if (!pose.rotation.allFinite() || !pose.translation.allFinite() || !covariance.allFinite()) return false;
  if (!(pose.rotation * pose.rotation.transpose()).isIdentity(1e-9)) return false;
  if (!covariance.isApprox(covariance.transpose(), 1e-9) && !covariance.isZero()) return false;
  const Eigen::SelfAdjointEigenSolver<egraph::Matrix6d> eigen(covariance, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()[0] >= -1e-12 * (1.0 + eigen.eigenvalues()[5]);
}

}  // namespace eg::test
