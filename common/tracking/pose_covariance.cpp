#include "common/tracking/pose_covariance.hpp"

#include "common/geometry/so3.hpp"

namespace eg::tracking {

egraph::Matrix6d adjoint(const geometry::Pose& pose) {
  egraph::Matrix6d matrix = egraph::Matrix6d::Zero();
  matrix.topLeftCorner<3, 3>() = pose.rotation;
  matrix.bottomRightCorner<3, 3>() = pose.rotation;
  matrix.bottomLeftCorner<3, 3>() = geometry::hat(pose.translation) * pose.rotation;
  return matrix;
}

egraph::Matrix6d with_turns_of_camera(const egraph::Matrix6d& covariance, const geometry::Pose& world_from_camera,
                                      double variance) {
  const Eigen::Matrix<double, 6, 3> turns = adjoint(world_from_camera).leftCols<3>();
  const egraph::Matrix6d sum = covariance + variance * turns * turns.transpose();
  return 0.5 * (sum + sum.transpose());
}

}  // namespace eg::tracking
