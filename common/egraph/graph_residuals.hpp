#pragma once

#include <Eigen/Core>

#include "common/egraph/types.hpp"
#include "common/geometry/pose.hpp"

/// What the optimisation of the graph adds up: residuals that are zero when keyframes and landmarks agree with what was
/// measured. Unknowns change by R ← exp(δ) R and t ← t + τ for a keyframe's world_from_camera, and by
/// d ← (d + B ε) / |d + B ε| for a landmark's direction, B its tangent_basis().
namespace eg::egraph {

/// Equation 9 of the paper, VD_w = R_wc VD_c: how far a direction seen by a keyframe is from its landmark, in the
/// landmark's tangent plane (radians).
struct DirectionResidual {
  Eigen::Vector2d value;
  Eigen::Matrix<double, 2, 3> by_rotation;  ///< by δ
  Eigen::Matrix2d by_direction;             ///< by ε
  Eigen::Matrix2d information;              ///< rad⁻²

  /// `min_sigma`: radians; no direction of a real scene is known better.
  DirectionResidual(const Eigen::Matrix3d& world_from_camera, const Eigen::Vector3d& landmark,
                    const Eigen::Vector3d& in_camera, const Eigen::Matrix3d& covariance, double min_sigma);

  [[nodiscard]] double chi2() const { return value.dot(information * value); }
};

/// How far the relative pose of two keyframes is from the one that was measured: rotation vector and translation of
/// first_from_second * measured^-1 (radians, metres).
struct RelativePoseResidual {
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  Vector6d value;
  Matrix6d by_first;   ///< by (δ, τ) of the first keyframe
  Matrix6d by_second;  ///< by (δ, τ) of the second one
  Matrix6d information;
  Eigen::Matrix3d rotation_information;  ///< of the rotation alone: what it is worth when positions are not asked for

  RelativePoseResidual(const geometry::Pose& world_from_first, const geometry::Pose& world_from_second,
                       const RelativePose& measured);

  [[nodiscard]] double chi2() const { return value.dot(information * value); }
  [[nodiscard]] double rotation_chi2() const { return value.head<3>().dot(rotation_information * value.head<3>()); }
};

}  // namespace eg::egraph
