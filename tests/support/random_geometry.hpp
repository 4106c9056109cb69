#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/base/random.hpp"
#include "common/geometry/pose.hpp"
#include "common/geometry/so3.hpp"

/// Random geometric things for tests, all from a seeded generator.
namespace eg::test {

inline constexpr double kDegree = 3.14159265358979323846 / 180.0;

inline Eigen::Vector3d normal_vector(base::Random& random, double sigma = 1.0) {
  return sigma * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
}

inline Eigen::Vector3d uniform_vector(base::Random& random, double low, double high) {
  return {random.uniform(low, high), random.uniform(low, high), random.uniform(low, high)};
}

/// Uniform on the sphere.
inline Eigen::Vector3d random_direction(base::Random& random) { return normal_vector(random).normalized(); }

/// Uniform on SO(3) (Shoemake 1992).
inline Eigen::Matrix3d random_rotation(base::Random& random) {
  const Eigen::Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
  return q.normalized().toRotationMatrix();
}

inline geometry::Pose random_pose(base::Random& random, double position = 1.0) {
  return {random_rotation(random), normal_vector(random, position)};
}

/// A covariance of two numbers with standard deviations between `low` and `high`, correlated in any way.
inline Eigen::Matrix2d random_covariance(base::Random& random, double low, double high) {
  const Eigen::Vector2d sigma(random.uniform(low, high), random.uniform(low, high));
  const double correlation = random.uniform(-0.95, 0.95);
  Eigen::Matrix2d unit;
  unit << 1.0, correlation, correlation, 1.0;
  return sigma.asDiagonal() * unit * sigma.asDiagonal();
}

/// sigma² (I - d dᵀ): the same uncertainty across the direction on all sides.
inline Eigen::Matrix3d tangential_covariance(const Eigen::Vector3d& direction, double sigma) {
  return sigma * sigma * (Eigen::Matrix3d::Identity() - direction * direction.transpose());
}

/// The direction turned by normal noise of `sigma` radians about each of two axes across it.
inline Eigen::Vector3d disturbed_direction(const Eigen::Vector3d& direction, double sigma, base::Random& random) {
  const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(direction);
  const Eigen::Vector3d axis = sigma * (random.normal() * basis.col(0) + random.normal() * basis.col(1));
  return geometry::so3_exp(axis) * direction;
}

}  // namespace eg::test
