#include "common/egraph/graph_residuals.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "common/geometry/so3.hpp"

namespace eg::egraph {
namespace {

/// Floors on what a relative pose may claim to know (0.001°, 0.01 mm): an exact one must not divide by zero.
constexpr double kMinRotationVariance = 3e-10;
constexpr double kMinTranslationVariance = 1e-10;

/// d log(exp(a) exp(r)) / da at a = 0: the inverse of the left Jacobian of SO(3).
Eigen::Matrix3d inverse_left_jacobian(const Eigen::Vector3d& r) {
  const double angle = r.norm();
  const Eigen::Matrix3d cross = geometry::hat(r);
  const double factor =
      angle < 1e-3 ? 1.0 / 12.0 : 1.0 / (angle * angle) - (1.0 + std::cos(angle)) / (2.0 * angle * std::sin(angle));
  return Eigen::Matrix3d::Identity() - 0.5 * cross + factor * cross * cross;
}

Matrix6d floored(Matrix6d covariance) {
  covariance.diagonal().head<3>().array() += kMinRotationVariance;
  covariance.diagonal().tail<3>().array() += kMinTranslationVariance;
  return covariance;
}

}  // namespace

DirectionResidual::DirectionResidual(const Eigen::Matrix3d& world_from_camera, const Eigen::Vector3d& landmark,
                                     const Eigen::Vector3d& in_camera, const Eigen::Matrix3d& covariance,
                                     double min_sigma) {
  const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(landmark);
  const Eigen::Vector3d in_world = world_from_camera * in_camera;
  value = basis.transpose() * in_world;
  by_rotation = -basis.transpose() * geometry::hat(in_world);
  by_direction = -Eigen::Matrix2d::Identity();
  const Eigen::Matrix<double, 2, 3> project = basis.transpose() * world_from_camera;
  information =
      (project * covariance * project.transpose() + min_sigma * min_sigma * Eigen::Matrix2d::Identity()).inverse();
}

RelativePoseResidual::RelativePoseResidual(const geometry::Pose& world_from_first,
                                           const geometry::Pose& world_from_second, const RelativePose& measured) {
  const Eigen::Matrix3d first_from_world = world_from_first.rotation.transpose();
  const Eigen::Matrix3d rotation =
      first_from_world * world_from_second.rotation * measured.first_from_second.rotation.transpose();
  const Eigen::Vector3d apart = first_from_world * (world_from_second.translation - world_from_first.translation);
  const Eigen::Vector3d expected = rotation * measured.first_from_second.translation;
  value << geometry::so3_log(rotation), apart - expected;

  const Eigen::Matrix3d turn = inverse_left_jacobian(value.head<3>()) * first_from_world;
  by_first << -turn, Eigen::Matrix3d::Zero(), geometry::hat(value.tail<3>()) * first_from_world, -first_from_world;
  by_second << turn, Eigen::Matrix3d::Zero(), geometry::hat(expected) * first_from_world, first_from_world;
  const Matrix6d covariance = floored(measured.covariance);
  information = covariance.ldlt().solve(Matrix6d::Identity());
  rotation_information = covariance.topLeftCorner<3, 3>().inverse();
}

}  // namespace eg::egraph
