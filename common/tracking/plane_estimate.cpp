#include "common/tracking/plane_estimate.hpp"

#include <Eigen/LU>

#include "common/geometry/so3.hpp"

namespace eg::tracking {
namespace {

/// Columns: the two tangents of the normal, and the distance.
Eigen::Matrix<double, 4, 3> tangent_space(const geometry::Plane& plane) {
  Eigen::Matrix<double, 4, 3> basis = Eigen::Matrix<double, 4, 3>::Zero();
  basis.topLeftCorner<3, 2>() = geometry::tangent_basis(plane.normal);
  basis(3, 2) = 1.0;
  return basis;
}

/// Floor on the uncertainty of a plane (0.02°, 0.2 mm): exact data must not make a singular matrix.
Eigen::Matrix3d with_floor(const Eigen::Matrix3d& covariance) {
  return covariance + Eigen::Vector3d(1e-7, 1e-7, 4e-8).asDiagonal().toDenseMatrix();
}

}  // namespace

PlaneEstimate transform(const geometry::Pose& b_from_a, const PlaneEstimate& in_a) {
  Eigen::Matrix4d jacobian = Eigen::Matrix4d::Zero();
  jacobian.topLeftCorner<3, 3>() = b_from_a.rotation;
  jacobian.bottomLeftCorner<1, 3>() = -b_from_a.translation.transpose() * b_from_a.rotation;
  jacobian(3, 3) = 1.0;
  return {geometry::transform(b_from_a, in_a.plane), jacobian * in_a.covariance * jacobian.transpose()};
}

double height_variance(const PlaneEstimate& plane, const Eigen::Vector3d& point) {
  const Eigen::Vector4d gradient(point.x(), point.y(), point.z(), 1.0);
  return gradient.dot(plane.covariance * gradient);
}

void fuse(PlaneEstimate& plane, const PlaneEstimate& measurement) {
  const Eigen::Matrix<double, 4, 3> basis = tangent_space(plane.plane);
  const Eigen::Matrix3d prior = with_floor(basis.transpose() * plane.covariance * basis);
  const Eigen::Matrix3d measured = with_floor(basis.transpose() * measurement.covariance * basis);
  Eigen::Vector4d difference;
  difference << measurement.plane.normal - plane.plane.normal, measurement.plane.distance - plane.plane.distance;
  const Eigen::Matrix3d gain = prior * (prior + measured).inverse();
  const Eigen::Vector3d step = gain * (basis.transpose() * difference);
  const Eigen::Matrix3d posterior = (Eigen::Matrix3d::Identity() - gain) * prior;
  plane.plane.normal = (plane.plane.normal + basis.topLeftCorner<3, 2>() * step.head<2>()).normalized();
  plane.plane.distance += step.z();
  plane.covariance = basis * (0.5 * (posterior + posterior.transpose())) * basis.transpose();
}

}  // namespace eg::tracking
