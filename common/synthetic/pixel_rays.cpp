#include "common/synthetic/pixel_rays.hpp"

#include <Eigen/LU>

namespace eg::synthetic {
namespace {

struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d jacobian;
};

/// Brown's model in OpenCV's order k1 k2 p1 p2 k3, on normalised coordinates, with its derivative.
Distorted distort(const std::array<double, 5>& k, const Eigen::Vector2d& ray) {
  const double x = ray.x();
  const double y = ray.y();
  const double r2 = ray.squaredNorm();
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double radial_by_r2 = k[0] + r2 * (2.0 * k[1] + 3.0 * r2 * k[4]);
  Distorted result;
  result.point << x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x),
      y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y;
  const double mixed = 2.0 * x * y * radial_by_r2 + 2.0 * k[2] * x + 2.0 * k[3] * y;
  result.jacobian << radial + 2.0 * x * x * radial_by_r2 + 2.0 * k[2] * y + 6.0 * k[3] * x, mixed, mixed,
      radial + 2.0 * y * y * radial_by_r2 + 6.0 * k[2] * y + 2.0 * k[3] * x;
  return result;
}

}  // namespace

Eigen::Vector2d distorted_pixel(const geometry::CameraModel& camera, const Eigen::Vector2d& ray) {
  const Eigen::Vector2d p = distort(camera.distortion, ray).point;
  return {camera.fx * p.x() + camera.cx, camera.fy * p.y() + camera.cy};
}

Eigen::Vector2d ray_of_pixel(const geometry::CameraModel& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d target = camera.ray(pixel).head<2>();
  if (!camera.has_distortion()) return target;
  Eigen::Vector2d ray = target;
  constexpr int kMaxSteps = 30;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Distorted at = distort(camera.distortion, ray);
    const Eigen::Vector2d change = at.jacobian.inverse() * (target - at.point);
    ray += change;
    if (change.norm() < 1e-14) break;
  }
  return ray;
}

PixelRays::PixelRays(const geometry::CameraModel& camera) : stride_(static_cast<std::size_t>(camera.width) + 2) {
  rays_.reserve(stride_ * (static_cast<std::size_t>(camera.height) + 2));
  for (int y = -1; y <= camera.height; ++y) {
    for (int x = -1; x <= camera.width; ++x) rays_.push_back(ray_of_pixel(camera, Eigen::Vector2d(x, y)));
  }
}

}  // namespace eg::synthetic
