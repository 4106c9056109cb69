#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <limits>

#include "common/geometry/so3.hpp"
#include "common/tracking/pose_optimizer.hpp"

namespace eg::tracking {
namespace {

using PointJacobian = Eigen::Matrix<double, 3, 6>;

/// Of a point in the camera frame with respect to δ.
PointJacobian transformed_point_jacobian(const Eigen::Vector3d& point_in_camera) {
  PointJacobian jacobian;
  jacobian << -geometry::hat(point_in_camera), Eigen::Matrix3d::Identity();
  return jacobian;
}

Eigen::Matrix<double, 2, 3> projection_jacobian(const geometry::CameraModel& camera, const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << camera.fx / p.z(), 0.0, -camera.fx * p.x() / (p.z() * p.z()),  //
      0.0, camera.fy / p.z(), -camera.fy * p.y() / (p.z() * p.z());
  return jacobian;
}

}  // namespace

geometry::Pose perturb(const geometry::Pose& camera_from_world, const Vector6d& delta) {
  const Eigen::Matrix3d rotation = geometry::so3_exp(delta.head<3>());
  return {rotation * camera_from_world.rotation, rotation * camera_from_world.translation + delta.tail<3>()};
}

Vector6d pose_difference(const geometry::Pose& from, const geometry::Pose& to) {
  const geometry::Pose step = to * from.inverse();
  Vector6d delta;
  delta << geometry::so3_log(step.rotation), step.translation;
  return delta;
}

PointResidual point_residual(const PointFactor& factor, const geometry::CameraModel& camera,
                             const geometry::Pose& pose) {
  PointResidual at;
  const Eigen::Vector3d point = pose * factor.point_in_world;
  at.in_front = point.z() > kNearestProjection;
  if (!at.in_front) return at;
  const PointJacobian jacobian = transformed_point_jacobian(point);
  at.pixel = (camera.project(point) - factor.pixel) / factor.pixel_sigma;
  at.pixel_jacobian = projection_jacobian(camera, point) * jacobian / factor.pixel_sigma;
  if (factor.depth > 0.0) {
    at.depth = (point.z() - factor.depth) / factor.depth_sigma;
    at.depth_jacobian = jacobian.row(2) / factor.depth_sigma;
  }
  return at;
}

double reprojection_chi2(const PointFactor& factor, const geometry::CameraModel& camera, const geometry::Pose& pose) {
  const Eigen::Vector3d point = pose * factor.point_in_world;
  if (point.z() <= kNearestProjection) return std::numeric_limits<double>::infinity();
  return (camera.project(point) - factor.pixel).squaredNorm() / (factor.pixel_sigma * factor.pixel_sigma);
}

LineResidual line_residual(const LineFactor& factor, const geometry::CameraModel& camera, const geometry::Pose& pose) {
  LineResidual at;
  const Eigen::Vector3d ends[2] = {pose * factor.start_in_world, pose * factor.end_in_world};
  at.in_front = ends[0].z() > kNearestProjection && ends[1].z() > kNearestProjection;
  if (!at.in_front) return at;
  const Eigen::RowVector2d normal = factor.image_line.head<2>().transpose();
  for (int i = 0; i < 2; ++i) {
    at.distances[i] = factor.image_line.dot(camera.project(ends[i]).homogeneous());
    at.jacobian.row(i) = normal * projection_jacobian(camera, ends[i]) * transformed_point_jacobian(ends[i]);
  }
  at.distances = factor.whitener * at.distances;
  at.jacobian = factor.whitener * at.jacobian;
  return at;
}

PlaneResidual plane_residual(const PlaneFactor& factor, const geometry::Pose& pose) {
  // In the camera frame: n_c = R n_w, d_c = d_w - n_c · t. Under δ = (ω, v): d n_c = ω × n_c, d d_c = -n_c · v.
  const geometry::Plane plane = geometry::transform(pose, factor.plane_in_world);
  PlaneResidual at;
  at.height = plane.signed_distance(factor.centroid_in_camera) / factor.sigma;
  at.jacobian << plane.normal.cross(factor.centroid_in_camera).transpose(), -plane.normal.transpose();
  at.jacobian /= factor.sigma;
  return at;
}

DirectionResidual direction_residual(const DirectionFactor& factor, const geometry::Pose& pose) {
  const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(factor.direction_in_camera);
  const Eigen::Vector3d predicted = pose.rotation * factor.direction_in_world;
  // Floor of 0.01° keeps exact data from dividing by zero.
  const Eigen::Matrix2d covariance = basis.transpose() * factor.covariance * basis + 3e-8 * Eigen::Matrix2d::Identity();
  const Eigen::LLT<Eigen::Matrix2d> whiten(covariance);
  DirectionResidual at;
  at.angle = whiten.matrixL().solve(basis.transpose() * predicted);
  at.jacobian.leftCols<3>() =
      whiten.matrixL().solve(Eigen::Matrix<double, 2, 3>(-basis.transpose() * geometry::hat(predicted)));
  at.jacobian.rightCols<3>().setZero();
  return at;
}

}  // namespace eg::tracking
