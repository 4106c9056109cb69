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

/// The solved pose, but with the predicted position along every direction in which the measurements leave it more
/// uncertain than `max_translation_sigma` (metres): there a few wrong matches would carry the camera away. A turn that
/// the measurements leave open is as uncertain as the prediction's.
geometry::Pose keep_predicted_where_unobserved(const MotionPrior& prediction, const geometry::Pose& solved,
                                               const Matrix6d& information, double max_translation_sigma);

/// Covariance of (rotation, translation) of a left perturbation of world_from_camera, from the information about
/// camera_from_world. `prior` bounds what the measurements leave open.
Matrix6d world_covariance(const Matrix6d& information, const MotionPrior& prior,
                          const geometry::Pose& world_from_camera);

}  // namespace eg::tracking
