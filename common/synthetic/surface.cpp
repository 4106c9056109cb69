#include "common/synthetic/surface.hpp"

namespace eg::synthetic {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

bool Surface::contains(const Eigen::Vector2d& uv, double margin) const {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& from = outline[i];
    const Eigen::Vector2d side = outline[(i + 1) % outline.size()] - from;
    if (cross(side, uv - from) < -margin * side.norm()) return false;
  }
  return true;
}

double Surface::area() const {
  double twice = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) twice += cross(outline[i], outline[(i + 1) % outline.size()]);
  return 0.5 * twice;
}

Eigen::AlignedBox2d Surface::bounds() const {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : outline) box.extend(corner);
  return box;
}

}  // namespace eg::synthetic
