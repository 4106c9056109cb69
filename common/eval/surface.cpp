#include "common/eval/surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/base/check.hpp"

namespace eg::eval {
namespace {

using Eigen::Vector3f;

constexpr double kMostParts = 1000.0;  ///< of a triangle's edge: a vertex gone astray does not fill the memory

struct Triangle {
  Vector3f a, b, c;
};

Triangle triangle_at(const SurfaceView& surface, std::size_t index) {
  const auto& [a, b, c] = surface.triangles[index];
  const std::size_t count = surface.vertices.size();
  EG_CHECK(a < count && b < count && c < count, "a triangle refers to a vertex that does not exist");
  return {surface.vertices[a], surface.vertices[b], surface.vertices[c]};
}

/// Appends the centres of the n² parts of a triangle.
void sample_triangle(const Triangle& t, double spacing, SurfaceSamples& result, std::uint32_t index) {
  const float area = 0.5F * (t.b - t.a).cross(t.c - t.a).norm();
  if (!(area > 0.0F)) return;
  const float longest = std::max({(t.b - t.a).norm(), (t.c - t.b).norm(), (t.a - t.c).norm()});
  const int n = static_cast<int>(std::clamp(std::ceil(longest / spacing), 1.0, kMostParts));
  const Vector3f u = (t.b - t.a) / static_cast<float>(n), v = (t.c - t.a) / static_cast<float>(n);
  const auto add = [&](float along_u, float along_v) {
    result.samples.push_back({t.a + along_u * u + along_v * v, area / static_cast<float>(n * n)});
    result.triangle.push_back(index);
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      const auto x = static_cast<float>(i), y = static_cast<float>(j);
      add(x + 1.0F / 3.0F, y + 1.0F / 3.0F);
      if (i + j + 1 < n) add(x + 2.0F / 3.0F, y + 2.0F / 3.0F);
    }
  }
}

}  // namespace

SurfaceSamples sample_surface(const SurfaceView& surface, double spacing) {
  EG_CHECK(spacing > 0.0, "samples need a positive spacing");
  SurfaceSamples result;
  if (surface.triangles.empty()) {
    for (const Vector3f& vertex : surface.vertices) result.samples.push_back({vertex, 1.0F});
    return result;
  }
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    sample_triangle(triangle_at(surface, i), spacing, result, static_cast<std::uint32_t>(i));
  }
  return result;
}

float distance_to_triangle(const Vector3f& p, const Vector3f& a, const Vector3f& b, const Vector3f& c) {
  // Each test finds the feature (corner, edge, face) whose Voronoi region the point is in.
  const Vector3f ab = b - a, ac = c - a, ap = p - a;
  const float d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return ap.norm();
  const Vector3f bp = p - b;
  const float d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return bp.norm();
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return (ap - d1 / (d1 - d3) * ab).norm();
  const Vector3f cp = p - c;
  const float d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return cp.norm();
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return (ap - d2 / (d2 - d6) * ac).norm();
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return (bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).norm();
  }
  return std::abs(ab.cross(ac).normalized().dot(ap));
}

}  // namespace eg::eval
