#include "common/tracking/pose_covariance.hpp"

#include <Eigen/LU>

#include "common/geometry/so3.hpp"

namespace eg::tracking {

Matrix6d adjoint(const geometry::Pose& pose) {
  Matrix6d matrix = Matrix6d::Zero();
  matrix.topLeftCorner<3, 3>() = pose.rotation;
  matrix.bottomRightCorner<3, 3>() = pose.rotation;
  matrix.bottomLeftCorner<3, 3>() = geometry::hat(pose.translation) * pose.rotation;
  return matrix;
}

Matrix6d camera_covariance(const Matrix6d& information, const MotionPrior& prior) {
  return (information + prior.covariance.inverse()).inverse();
}

Matrix6d world_covariance(const Matrix6d& information, const MotionPrior& prior,
                          const geometry::Pose& world_from_camera) {
  const Matrix6d to_world = adjoint(world_from_camera);
  const Matrix6d in_world = to_world * camera_covariance(information, prior) * to_world.transpose();
  return 0.5 * (in_world + in_world.transpose());
}

Matrix6d with_turns_of_camera(const Matrix6d& covariance, const geometry::Pose& world_from_camera, double variance) {
  const Eigen::Matrix<double, 6, 3> turns = adjoint(world_from_camera).leftCols<3>();
  const Matrix6d sum = covariance + variance * turns * turns.transpose();
  return 0.5 * (sum + sum.transpose());
}

}  // namespace eg::tracking
