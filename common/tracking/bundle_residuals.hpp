#pragma once

#include <Eigen/Core>

#include "common/tracking/pose_optimizer.hpp"

/// What a keyframe's observation of a landmark says about both, for bundle adjustment. Residuals are in units of their
/// standard deviations; the pose is perturbed as everywhere here, T = exp(δ) T of camera_from_world. Each of them is
/// the residual of the frame-to-map refinement (pose_optimizer.hpp) with the landmark free as well.
namespace eg::tracking {

/// A residual of N numbers and its derivatives by the pose and by a landmark of M parameters. Zero where the landmark
/// is behind the camera.
template <int N, int M>
struct BundleResidual {
  Eigen::Matrix<double, N, 1> value = Eigen::Matrix<double, N, 1>::Zero();
  Eigen::Matrix<double, N, 6> by_pose = Eigen::Matrix<double, N, 6>::Zero();
  Eigen::Matrix<double, N, M> by_landmark = Eigen::Matrix<double, N, M>::Zero();
};

/// Pixel and depth of a point at factor.point_in_world. Without depth the third number is zero.
BundleResidual<3, 3> bundle_point_residual(const PointFactor& factor, const geometry::CameraModel& camera,
                                           const geometry::Pose& camera_from_world);

/// The straight lines near a segment, by the four numbers that they have: how far each end point is moved across it.
/// Moves along it change nothing that can be seen.
struct LineChart {
  LineChart(const Eigen::Vector3d& start_in_world, const Eigen::Vector3d& end_in_world);

  [[nodiscard]] Eigen::Vector3d start_at(const Eigen::Vector4d& offsets) const {
    return start + across * offsets.head<2>();
  }
  [[nodiscard]] Eigen::Vector3d end_at(const Eigen::Vector4d& offsets) const {
    return end + across * offsets.tail<2>();
  }

  Eigen::Vector3d start;
  Eigen::Vector3d end;
  Eigen::Matrix<double, 3, 2> across;  ///< orthonormal columns, world
};

/// A segment seen in the image and, where it has depth, in space.
struct LineObservation {
  Eigen::Vector3d image_line = Eigen::Vector3d::UnitX();         ///< as LineFactor
  Eigen::Matrix2d image_whitener = Eigen::Matrix2d::Identity();  ///< as LineFactor
  bool has_depth = false;
  Eigen::Vector3d point_in_camera = Eigen::Vector3d::Zero();  ///< any point of the measured line
  Eigen::Vector3d inwards = Eigen::Vector3d::UnitZ();  ///< across the line, within the plane of line and camera centre
  Eigen::Matrix2d inwards_whitener = Eigen::Matrix2d::Identity();  ///< of the landmark's ends' distances along it
};

/// Distances in the image of both end points from the seen line, and their distances in space along `inwards`, which
/// the image does not show.
BundleResidual<4, 4> bundle_line_residual(const LineObservation& seen, const LineChart& chart,
                                          const Eigen::Vector4d& offsets, const geometry::CameraModel& camera,
                                          const geometry::Pose& camera_from_world);

/// A planar region: its normal, and the height of its centroid. At the centroid their errors are uncorrelated.
struct PlaneObservation {
  Eigen::Vector3d normal_in_camera = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d normal_covariance = Eigen::Matrix3d::Zero();  ///< rad²
  Eigen::Vector3d centroid_in_camera = Eigen::Vector3d::Zero();
  double height_sigma = 1.0;  ///< metres
};

/// The plane's parameters are minimal: the two tangents of its normal (geometry::tangent_basis), and its distance.
BundleResidual<3, 3> bundle_plane_residual(const PlaneObservation& seen, const geometry::Plane& plane_in_world,
                                           const geometry::Pose& camera_from_world);

/// The plane moved in those parameters.
geometry::Plane move_plane(const geometry::Plane& plane, const Eigen::Vector3d& tangents_and_distance);

/// The parameters that move `from` to `to`; inverse of move_plane.
Eigen::Vector3d plane_difference(const geometry::Plane& from, const geometry::Plane& to);

}  // namespace eg::tracking
