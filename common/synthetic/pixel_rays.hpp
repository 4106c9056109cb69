#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/camera_model.hpp"

namespace eg::synthetic {

/// Where a camera with Brown's distortion images the undistorted ray (x, y, 1); pixels.
Eigen::Vector2d distorted_pixel(const geometry::CameraModel& camera, const Eigen::Vector2d& ray);

/// The ray (x, y, 1) that a camera images at `pixel`: the inverse of the above by Newton's method, exact to rounding
/// for every pixel of a sound calibration.
Eigen::Vector2d ray_of_pixel(const geometry::CameraModel& camera, const Eigen::Vector2d& pixel);

/// The rays of all pixels of a camera and of one more pixel around the image.
class PixelRays {
 public:
  explicit PixelRays(const geometry::CameraModel& camera);

  /// x in [-1, width], y in [-1, height].
  [[nodiscard]] const Eigen::Vector2d& at(int x, int y) const {
    return rays_[static_cast<std::size_t>(y + 1) * stride_ + static_cast<std::size_t>(x + 1)];
  }
  /// Change of the ray from one pixel to the next, for positions between pixels.
  [[nodiscard]] Eigen::Vector2d step_x(int x, int y) const { return 0.5 * (at(x + 1, y) - at(x - 1, y)); }
  [[nodiscard]] Eigen::Vector2d step_y(int x, int y) const { return 0.5 * (at(x, y + 1) - at(x, y - 1)); }

 private:
  std::size_t stride_;
  std::vector<Eigen::Vector2d> rays_;
};

}  // namespace eg::synthetic
