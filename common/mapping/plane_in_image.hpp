#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/geometry/plane.hpp"

namespace eg::mapping {

/// A plane that somebody has found in a depth image.
struct DepthPlane {
  geometry::Plane plane;  ///< in the camera frame, normal towards the camera (distance > 0)
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< of (normal, distance)
  double support = 0;                                    ///< readings that belong to it
  std::vector<Eigen::Vector3d> hull;                     ///< convex, on the plane, camera frame, metres; in order
};

/// The same as the pixels show it. Inverse depth is linear in the pixel: 1/z = coefficients · (u, v, 1).
struct PlaneInImage {
  struct Span {
    int begin = 0;
    int end = 0;  ///< one behind the last column; equal: none
  };

  Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();  ///< 1/(metre pixel), the last 1/metre
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();    ///< of the coefficients
  double support = 0;
  int first_row = 0;
  std::vector<Span> spans;  ///< columns inside the hull and the image, of the rows from first_row on

  /// Empty outside.
  [[nodiscard]] Span span(int row) const {
    const int index = row - first_row;
    return index < 0 || index >= static_cast<int>(spans.size()) ? Span{} : spans[static_cast<std::size_t>(index)];
  }

  [[nodiscard]] double inverse_depth(double u, double v) const { return coefficients.dot(Eigen::Vector3d(u, v, 1.0)); }

  /// Variance of inverse_depth().
  [[nodiscard]] double variance(double u, double v) const {
    const Eigen::Vector3d pixel(u, v, 1.0);
    return pixel.dot(covariance * pixel);
  }
};

/// `camera` has no distortion. Nothing if a number is not finite, the normal is no unit vector, the plane or a part of
/// its hull is not before the camera, or the hull is outside the image.
std::optional<PlaneInImage> project(const DepthPlane& plane, const geometry::CameraModel& camera);

}  // namespace eg::mapping
