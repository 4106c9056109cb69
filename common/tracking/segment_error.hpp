#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace eg::tracking {

// A straight line through two measured points is a lever: beyond them it errs the more, the farther one goes.

/// Where along the segment from `start` to `end` a point lies: 0 at the start, 1 at the end, beyond them outside.
template <typename Vector>
double place_along(const Vector& start, const Vector& end, const Vector& point) {
  const Vector along = end - start;
  return along.dot(point - start) / along.squaredNorm();
}

/// The variance (number or matrix) of the line at a place, when its two points err independently of each other.
template <typename Variance>
Variance variance_along(const Variance& of_start, const Variance& of_end, double place) {
  return (1.0 - place) * (1.0 - place) * of_start + place * place * of_end;
}

/// The covariance of the line's errors at two places.
inline Eigen::Matrix2d covariance_along(double variance_of_start, double variance_of_end,
                                        const Eigen::Vector2d& places) {
  Eigen::Matrix2d lever;
  lever << 1.0 - places[0], places[0], 1.0 - places[1], places[1];
  return lever * Eigen::Vector2d(variance_of_start, variance_of_end).asDiagonal() * lever.transpose();
}

/// W such that W r has unit covariance where r has the given one.
inline Eigen::Matrix2d whitener(const Eigen::Matrix2d& covariance) {
  return covariance.llt().matrixL().solve(Eigen::Matrix2d::Identity());
}

}  // namespace eg::tracking
