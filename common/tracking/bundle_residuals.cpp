#include "common/tracking/bundle_residuals.hpp"

#include <Eigen/Geometry>

#include "common/geometry/so3.hpp"

namespace eg::tracking {
namespace {

using geometry::Pose;

/// δ = (ω, v) moves a point in the camera by ω × p + v, a point of the world by R dX: a derivative by v is one by dX.
template <int N>
Eigen::Matrix<double, N, 3> by_world_point(const Eigen::Matrix<double, N, 6>& by_pose, const Pose& camera_from_world) {
  return by_pose.template rightCols<3>() * camera_from_world.rotation;
}

}  // namespace

BundleResidual<3, 3> bundle_point_residual(const PointFactor& factor, const geometry::CameraModel& camera,
                                           const Pose& camera_from_world) {
  BundleResidual<3, 3> at;
  const PointResidual residual = point_residual(factor, camera, camera_from_world);
  if (!residual.in_front) return at;
  at.value.head<2>() = residual.pixel;
  at.by_pose.topRows<2>() = residual.pixel_jacobian;
  if (factor.depth > 0.0) {
    at.value.z() = residual.depth;
    at.by_pose.bottomRows<1>() = residual.depth_jacobian;
  }
  at.by_landmark = by_world_point<3>(at.by_pose, camera_from_world);
  return at;
}

LineChart::LineChart(const Eigen::Vector3d& start_in_world, const Eigen::Vector3d& end_in_world)
    : start(start_in_world),
      end(end_in_world),
      across(geometry::tangent_basis((end_in_world - start_in_world).normalized())) {}

BundleResidual<4, 4> bundle_line_residual(const LineObservation& seen, const LineChart& chart,
                                          const Eigen::Vector4d& offsets, const geometry::CameraModel& camera,
                                          const Pose& camera_from_world) {
  BundleResidual<4, 4> at;
  const LineFactor factor{chart.start_at(offsets), chart.end_at(offsets), seen.image_line, Eigen::Matrix2d::Identity()};
  const LineResidual residual = line_residual(factor, camera, camera_from_world);
  if (!residual.in_front) return at;
  at.value.head<2>() = residual.distances;
  at.by_pose.topRows<2>() = residual.jacobian;
  if (seen.has_depth) {
    const Eigen::Vector3d ends[2] = {camera_from_world * factor.start_in_world,
                                     camera_from_world * factor.end_in_world};
    for (int i = 0; i < 2; ++i) {
      at.value[2 + i] = seen.inwards.dot(ends[i] - seen.point_in_camera);
      at.by_pose.row(2 + i) << ends[i].cross(seen.inwards).transpose(), seen.inwards.transpose();
    }
  }
  const Eigen::Matrix<double, 4, 2> by_end = by_world_point<4>(at.by_pose, camera_from_world) * chart.across;
  for (int i = 0; i < 4; ++i) at.by_landmark.block<1, 2>(i, 2 * (i % 2)) = by_end.row(i);

  Eigen::Matrix4d whitener = Eigen::Matrix4d::Zero();
  whitener.topLeftCorner<2, 2>() = seen.image_whitener;
  whitener.bottomRightCorner<2, 2>() = seen.inwards_whitener;
  return {whitener * at.value, whitener * at.by_pose, whitener * at.by_landmark};
}

BundleResidual<3, 3> bundle_plane_residual(const PlaneObservation& seen, const geometry::Plane& plane_in_world,
                                           const Pose& camera_from_world) {
  BundleResidual<3, 3> at;
  const Eigen::Matrix<double, 3, 2> tangents = geometry::tangent_basis(plane_in_world.normal);
  const DirectionResidual turned =
      direction_residual({plane_in_world.normal, seen.normal_in_camera, seen.normal_covariance}, camera_from_world);
  at.value.head<2>() = turned.angle;
  at.by_pose.topRows<2>() = turned.jacobian;
  // ω turns the normal n by ω × n; the ω that moves it by a tangent dn is n × dn.
  const Eigen::Vector3d normal_in_camera = camera_from_world.rotation * plane_in_world.normal;
  at.by_landmark.topLeftCorner<2, 2>() =
      turned.jacobian.leftCols<3>() * geometry::hat(normal_in_camera) * camera_from_world.rotation * tangents;

  const PlaneResidual height =
      plane_residual({plane_in_world, seen.centroid_in_camera, seen.height_sigma}, camera_from_world);
  const Eigen::Vector3d centroid_in_world = camera_from_world.inverse() * seen.centroid_in_camera;
  at.value.z() = height.height;
  at.by_pose.bottomRows<1>() = height.jacobian;
  at.by_landmark.bottomRows<1>() << centroid_in_world.transpose() * tangents / seen.height_sigma,
      1.0 / seen.height_sigma;
  return at;
}

geometry::Plane move_plane(const geometry::Plane& plane, const Eigen::Vector3d& tangents_and_distance) {
  const Eigen::Vector3d moved = plane.normal + geometry::tangent_basis(plane.normal) * tangents_and_distance.head<2>();
  return {moved.normalized(), plane.distance + tangents_and_distance.z()};
}

Eigen::Vector3d plane_difference(const geometry::Plane& from, const geometry::Plane& to) {
  // Projected from the centre onto the tangent plane of `from`, as move_plane projects back.
  const Eigen::Vector3d tangential = to.normal / to.normal.dot(from.normal) - from.normal;
  Eigen::Vector3d difference;
  difference << geometry::tangent_basis(from.normal).transpose() * tangential, to.distance - from.distance;
  return difference;
}

}  // namespace eg::tracking
