#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "common/eval/render.hpp"

namespace eg::eval {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

/// The mean of the triangles' normals (of either sign) that are within `limit` radians of `axis`, weighted by area.
Eigen::Vector3d mean_normal_near(const SurfaceView& shape, const Eigen::Vector3d& axis, double limit) {
  const double smallest_cosine = std::cos(limit);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& [a, b, c] : shape.triangles) {
    const Eigen::Vector3d corner = shape.vertices[a].cast<double>();
    const Eigen::Vector3d weighted =
        (shape.vertices[b].cast<double>() - corner).cross(shape.vertices[c].cast<double>() - corner);
    const double along = weighted.dot(axis);
    if (std::abs(along) > smallest_cosine * weighted.norm()) sum += along > 0 ? weighted : -weighted;
  }
  return sum.norm() > 0.0 ? sum.normalized() : axis;
}

}  // namespace

Eigen::Vector3d refine_up(const ColouredSurface& surface, const Eigen::Vector3d& guess) {
  // From wide to narrow, so that furniture and noise of other directions drop out.
  Eigen::Vector3d up = guess.normalized();
  for (const double limit_deg : {40.0, 25.0, 15.0, 8.0, 8.0}) {
    up = mean_normal_near(surface.shape, up, limit_deg * kRadiansPerDegree);
  }
  return up;
}

}  // namespace eg::eval
