#pragma once

#include "common/tracking/pose_optimizer.hpp"

namespace eg::tracking {

/// How well the measurements alone determine the pose: standard deviations along the worst direction.
struct Observability {
  double rotation_sigma = 0.0;                            ///< radians; infinite if unobserved
  double second_rotation_sigma = 0.0;                     ///< radians, along the second worst direction
  Eigen::Vector3d worst_turn = Eigen::Vector3d::UnitZ();  ///< axis of rotation_sigma, camera frame
  double translation_sigma = 0.0;                         ///< metres; infinite if unobserved
};

Observability observability(const Matrix6d& information);

/// Covariance of (rotation, translation) of a left perturbation of camera_from_world, from measurements and prior.
Matrix6d camera_covariance(const Matrix6d& information, const MotionPrior& prior);

/// Covariance of (rotation, translation) of a left perturbation of world_from_camera, from the information about
/// camera_from_world. `prior` bounds what the measurements leave open.
Matrix6d world_covariance(const Matrix6d& information, const MotionPrior& prior,
                          const geometry::Pose& world_from_camera);

}  // namespace eg::tracking
