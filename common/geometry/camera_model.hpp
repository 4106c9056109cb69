#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace eg::geometry {

/// A pinhole camera with Brown's distortion whose depth image is registered to its colour image.
/// A negative `fy` (ICL-NUIM) is used as it stands: the camera frame's y axis then points up and the world is the data
/// set's own; all of the project's mathematics holds in either case (docs/frames.md).
struct CameraModel {
  std::string name;
  int width = 0;    ///< pixels
  int height = 0;   ///< pixels
  double fx = 0.0;  ///< pixels
  double fy = 0.0;  ///< pixels; may be negative
  double cx = 0.0;  ///< pixels, 0 is the centre of the first pixel
  double cy = 0.0;
  std::array<double, 5> distortion{};  ///< k1 k2 p1 p2 k3 (OpenCV's order); all zero: none
  double depth_units_per_metre = 0.0;  ///< raw depth value of one metre
  double fps = 0.0;                    ///< nominal frame rate, 1/s

  [[nodiscard]] bool has_distortion() const;

  /// Pixel of a point in the camera frame with z > 0, without distortion.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& point_in_camera) const {
    return {fx * point_in_camera.x() / point_in_camera.z() + cx, fy * point_in_camera.y() / point_in_camera.z() + cy};
  }

  /// The ray through a pixel, scaled to z = 1, without distortion.
  [[nodiscard]] Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const {
    return {(pixel.x() - cx) / fx, (pixel.y() - cy) / fy, 1.0};
  }

  /// The point in the camera frame at a pixel and depth (z, metres), without distortion.
  [[nodiscard]] Eigen::Vector3d unproject(const Eigen::Vector2d& pixel, double depth) const { return depth * ray(pixel); }

  [[nodiscard]] bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= width - 1 && pixel.y() <= height - 1;
  }

  bool operator==(const CameraModel&) const = default;
};

/// Says what is wrong with a camera model (non-positive sizes, zero focal lengths, missing depth scale, non-finite values).
base::Status validate(const CameraModel& camera);

/// The camera models known by name: icl, tum_fr1, tum_fr2, tum_fr3, synthetic.
std::optional<CameraModel> find_camera(std::string_view name);
std::vector<std::string> camera_names();

}  // namespace eg::geometry
