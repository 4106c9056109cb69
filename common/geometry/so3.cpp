#include "common/geometry/so3.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>

namespace eg::geometry {

Eigen::Matrix3d hat(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d so3_exp(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d k = hat(w);
  // Series below 1e-6 rad: the quotients lose all digits there.
  const double a = angle < 1e-6 ? 1.0 - angle * angle / 6.0 : std::sin(angle) / angle;
  const double b = angle < 1e-6 ? 0.5 - angle * angle / 24.0 : (1.0 - std::cos(angle)) / (angle * angle);
  return Eigen::Matrix3d::Identity() + a * k + b * k * k;
}

Eigen::Vector3d so3_log(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q(rotation);
  const double sign = q.w() < 0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * q.vec();
  const double s = v.norm();
  if (s < 1e-9) return 2.0 * v;
  return 2.0 * std::atan2(s, sign * q.w()) / s * v;
}

double rotation_angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return so3_log(a.transpose() * b).norm();
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
}

Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& direction) {
  Eigen::Index smallest = 0;
  direction.cwiseAbs().minCoeff(&smallest);
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = direction.cross(Eigen::Vector3d::Unit(smallest)).normalized();
  basis.col(1) = direction.cross(basis.col(0));
  return basis;
}

double axial_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), std::abs(a.dot(b)));
}

}  // namespace eg::geometry
