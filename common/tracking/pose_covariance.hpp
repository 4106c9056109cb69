#pragma once

#include "common/egraph/types.hpp"
#include "common/geometry/pose.hpp"

namespace eg::tracking {

/// The adjoint of a pose: takes left perturbations δ = (rotation, translation) of x to those of pose * x,
/// pose exp(δ) x = exp(Ad δ) pose x. A covariance C of the one is Ad C Ad^T of the other.
egraph::Matrix6d adjoint(const geometry::Pose& pose);

/// The covariance of world_from_camera (left perturbation, world frame; rad, m) with independent turns of `variance`
/// (rad²) about the camera's own axes added. They leave the camera where it is: as perturbations of the world, which
/// turn about its origin, they are coupled with the translation that brings the camera back.
egraph::Matrix6d with_turns_of_camera(const egraph::Matrix6d& covariance, const geometry::Pose& world_from_camera,
                                      double variance);

}  // namespace eg::tracking
