#include "common/eval/view.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/geometry/so3.hpp"

namespace eg::eval {
namespace {

/// The interval of all values; of all but 1 % at each side where that makes it much shorter, because those are
/// outliers.
std::pair<double, double> interval_without_outliers(std::vector<double> values) {
  constexpr double kMuchShorter = 0.3;
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() / 100;
  const double low = values[cut], high = values[values.size() - 1 - cut];
  const double longest_tail = kMuchShorter * (high - low);
  return {low - values.front() <= longest_tail ? values.front() : low,
          values.back() - high <= longest_tail ? values.back() : high};
}

}  // namespace

OrthographicView::OrthographicView(const Eigen::Vector3d& up, const Eigen::Vector3d& ahead, double azimuth,
                                   double elevation, bool mirrored) {
  Eigen::Vector3d level = ahead - ahead.dot(up) * up;
  if (level.norm() < 1e-6) level = geometry::tangent_basis(up).col(0);
  const double handedness = mirrored ? -1.0 : 1.0;
  level = geometry::so3_exp(handedness * azimuth * up) * level.normalized();
  forward_ = std::cos(elevation) * level - std::sin(elevation) * up;
  right_ = handedness * level.cross(up);
  down_ = -(std::cos(elevation) * up + std::sin(elevation) * level);
}

void OrthographicView::fit(std::span<const Eigen::Vector3d> points, const cv::Rect& rectangle) {
  if (points.empty()) return;
  std::vector<double> across, downward;
  for (const Eigen::Vector3d& point : points) {
    across.push_back(right_.dot(point));
    downward.push_back(down_.dot(point));
  }
  const auto [left, right] = interval_without_outliers(std::move(across));
  const auto [top, bottom] = interval_without_outliers(std::move(downward));
  constexpr double kSmallestExtent = 1e-3;
  scale_ = std::min(rectangle.width / std::max(right - left, kSmallestExtent),
                    rectangle.height / std::max(bottom - top, kSmallestExtent));
  offset_ = {rectangle.x + 0.5 * rectangle.width - scale_ * 0.5 * (left + right),
             rectangle.y + 0.5 * rectangle.height - scale_ * 0.5 * (top + bottom)};
}

cv::Point2d OrthographicView::pixel(const Eigen::Vector3d& point) const {
  return {offset_.x + scale_ * right_.dot(point), offset_.y + scale_ * down_.dot(point)};
}

}  // namespace eg::eval
