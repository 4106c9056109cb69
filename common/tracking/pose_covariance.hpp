#pragma once

#include "common/geometry/pose.hpp"
#include "common/tracking/pose_optimizer.hpp"

namespace eg::tracking {

/// The adjoint of a pose: takes left perturbations δ = (rotation, translation) of x to those of pose * x,
/// pose exp(δ) x = exp(Ad δ) pose x. A covariance C of the one is Ad C Ad^T of the other.
Matrix6d adjoint(const geometry::Pose& pose);

/// Covariance of (rotation, translation) of a left perturbation of camera_from_world, from measurements and prior.
Matrix6d camera_covariance(const Matrix6d& information, const MotionPrior& prior);

/// Covariance of (rotation, translation) of a left perturbation of world_from_camera, from the information about
/// camera_from_world. `prior` bounds what the measurements leave open.
Matrix6d world_covariance(const Matrix6d& information, const MotionPrior& prior,
                          const geometry::Pose& world_from_camera);

/// The covariance of world_from_camera (left perturbation, world frame; rad, m) with independent turns of `variance`
/// (rad²) about the camera's own axes added. They leave the camera where it is: as perturbations of the world, which
/// turn about its origin, they are coupled with the translation that brings the camera back.
Matrix6d with_turns_of_camera(const Matrix6d& covariance, const geometry::Pose& world_from_camera, double variance);

}  // namespace eg::tracking
