#include "common/eval/view.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/geometry/so3.hpp"

namespace eg::eval {
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

OrthographicView::Interval OrthographicView::extent(std::span<const Eigen::Vector3d> surface,
                                                    std::span<const Eigen::Vector3d> paths,
                                                    const Eigen::Vector3d& axis) {
  Interval interval{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  std::vector<double> values;
  for (const Eigen::Vector3d& point : surface) values.push_back(axis.dot(point));
  if (!values.empty()) {
    constexpr double kLongestTail = 0.3;  // of the rest; what reaches further out is an outlier
    std::sort(values.begin(), values.end());
    const std::size_t cut = values.size() / 100;
    const double low = values[cut], high = values[values.size() - 1 - cut];
    const double longest_tail = kLongestTail * (high - low);
    interval = {low - values.front() <= longest_tail ? values.front() : low,
                values.back() - high <= longest_tail ? values.back() : high};
  }
  for (const Eigen::Vector3d& point : paths) {
    interval = {std::min(interval.low, axis.dot(point)), std::max(interval.high, axis.dot(point))};
  }
  return interval;
}

void OrthographicView::fit(std::span<const Eigen::Vector3d> surface, std::span<const Eigen::Vector3d> paths,
                           const cv::Rect& rectangle) {
  if (surface.empty() && paths.empty()) return;
  const auto [left, right] = extent(surface, paths, right_);
  const auto [top, bottom] = extent(surface, paths, down_);
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
