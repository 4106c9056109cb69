#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/eval/render.hpp"
#include "common/eval/view.hpp"

namespace eg::eval {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

/// The normal by the order of the corners, as long as the triangle's area (times two).
Eigen::Vector3d area_normal(const SurfaceView& shape, const std::array<std::uint32_t, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const Eigen::Vector3d corner = shape.vertices[a].cast<double>();
  return (shape.vertices[b].cast<double>() - corner).cross(shape.vertices[c].cast<double>() - corner);
}

/// The same, turned to the side that the vertices' normals say is the front.
Eigen::Vector3d front_normal(const ColouredSurface& surface, const std::array<std::uint32_t, 3>& triangle) {
  const Eigen::Vector3d normal = area_normal(surface.shape, triangle);
  if (surface.normals.empty()) return normal;
  const auto& [a, b, c] = triangle;
  const Eigen::Vector3f front = surface.normals[a] + surface.normals[b] + surface.normals[c];
  return normal.dot(front.cast<double>()) < 0.0 ? -normal : normal;
}

/// The mean of the triangles' normals (of either sign) that are within `limit` radians of `axis`, weighted by area.
Eigen::Vector3d mean_normal_near(const SurfaceView& shape, const Eigen::Vector3d& axis, double limit) {
  const double smallest_cosine = std::cos(limit);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& triangle : shape.triangles) {
    const Eigen::Vector3d weighted = area_normal(shape, triangle);
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

double best_azimuth(const ColouredSurface& surface, const RenderOptions& options) {
  constexpr int kDirections = 24;
  double best = options.azimuth, largest_area = 0.0;
  for (int i = 0; i < kDirections; ++i) {
    const double azimuth = options.azimuth + 2.0 * std::numbers::pi * i / kDirections;
    const OrthographicView view(options.up, options.ahead, azimuth, options.elevation, options.mirrored);
    double area = 0.0;
    for (const auto& triangle : surface.shape.triangles) {
      area += std::max(0.0, -view.forward().dot(front_normal(surface, triangle)));
    }
    // A view must be clearly better than an earlier one to replace it: rounding should not choose.
    if (area <= largest_area * (1.0 + 1e-6)) continue;
    largest_area = area;
    best = azimuth;
  }
  return best;
}

}  // namespace eg::eval
