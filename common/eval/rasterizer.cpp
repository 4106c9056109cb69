#include "common/eval/rasterizer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace eg::eval {
namespace {

/// Twice the signed area of the triangle a, b, p: the edge function (Pineda, SIGGRAPH 1988).
double edge(const cv::Point2d& a, const cv::Point2d& b, const cv::Point2d& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

}  // namespace

Rasterizer::Rasterizer(cv::Size size, const cv::Vec3b& background)
    : image_(size, background), depth_(size, std::numeric_limits<float>::infinity()) {}

void Rasterizer::draw(const std::array<RasterVertex, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const double area = edge(a.pixel, b.pixel, c.pixel);
  if (!(std::abs(area) > 0.0)) return;
  const auto [left, right] = std::minmax({a.pixel.x, b.pixel.x, c.pixel.x});
  const auto [top, bottom] = std::minmax({a.pixel.y, b.pixel.y, c.pixel.y});
  const int first_x = static_cast<int>(std::ceil(std::clamp(left, 0.0, 1.0 * image_.cols)));
  const int last_x = static_cast<int>(std::floor(std::clamp(right, -1.0, image_.cols - 1.0)));
  const int first_y = static_cast<int>(std::ceil(std::clamp(top, 0.0, 1.0 * image_.rows)));
  const int last_y = static_cast<int>(std::floor(std::clamp(bottom, -1.0, image_.rows - 1.0)));
  for (int y = first_y; y <= last_y; ++y) {
    for (int x = first_x; x <= last_x; ++x) {
      const cv::Point2d p(x, y);
      const double u = edge(b.pixel, c.pixel, p) / area, v = edge(c.pixel, a.pixel, p) / area;
      const double w = edge(a.pixel, b.pixel, p) / area;
      if (u < 0.0 || v < 0.0 || w < 0.0) continue;
      const auto depth = static_cast<float>(u * a.depth + v * b.depth + w * c.depth);
      if (depth >= depth_(y, x)) continue;
      depth_(y, x) = depth;
      image_(y, x) =
          static_cast<float>(u) * a.colour + static_cast<float>(v) * b.colour + static_cast<float>(w) * c.colour;
    }
  }
}

}  // namespace eg::eval
