#include "common/features/line_depth_samples.hpp"

#include <algorithm>
#include <cmath>

#include "common/features/point_depth.hpp"
#include "common/geometry/depth_noise.hpp"

namespace eg::features {
namespace {

constexpr int kMaxStations = 48;
constexpr double kNear = 2.5;              // pixels off the segment: clear of blur and of misregistration
constexpr double kFar = 5.0;               // pixels: far enough from kNear to tell a surface's slope
constexpr double kMinOneSidedShare = 0.3;  // of the stations, for a segment to be at a depth edge

/// z at the nearest pixel; 0: none.
double depth_at(const cv::Mat& depth, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::lround(pixel.x()));
  const int y = static_cast<int>(std::lround(pixel.y()));
  if (x < 0 || y < 0 || x >= depth.cols || y >= depth.rows) return 0.0;
  const float z = depth.at<float>(y, x);
  return std::isfinite(z) && z > 0.0F ? z : 0.0;
}

int station_count(const Segment& segment) { return std::clamp(static_cast<int>(segment.length()), 2, kMaxStations); }

double station_fraction(int station, int count) { return (station + 0.5) / count; }

LineOwner find_owner(const cv::Mat& depth, const Segment& segment, int stations) {
  const Eigen::Vector2d step = kNear * segment.normal();
  int left = 0;
  int right = 0;
  for (int i = 0; i < stations; ++i) {
    const Eigen::Vector2d pixel = segment.at(station_fraction(i, stations));
    const double z_left = depth_at(depth, pixel - step);
    const double z_right = depth_at(depth, pixel + step);
    if (z_left <= 0.0 && z_right <= 0.0) continue;
    const double jump = depth_jump(std::max(z_left, z_right));
    if (z_right <= 0.0 || (z_left > 0.0 && z_left < z_right - jump)) ++left;
    if (z_left <= 0.0 || (z_right > 0.0 && z_right < z_left - jump)) ++right;
  }
  if (left + right < kMinOneSidedShare * stations) return LineOwner::both;
  return left >= right ? LineOwner::left : LineOwner::right;
}

/// Adds the reading `z` of the pixel nearest to `pixel`, at the place of that pixel's centre relative to the segment.
void add_sample(LineDepthSamples& result, const Segment& segment, const Eigen::Vector2d& step,
                const Eigen::Vector2d& pixel, double z) {
  ++result.expected;
  if (z <= 0.0) return;
  const Eigen::Vector2d centre(std::lround(pixel.x()), std::lround(pixel.y()));
  const double along = 2.0 * segment.unit().dot(centre - segment.at(0.5)) / segment.length();
  const double across = step.dot(centre - segment.start);
  result.samples.push_back({along, across, 1.0 / z, geometry::depth_sigma(z) / (z * z)});
}

/// Depth on the segment itself, or the mean of its two sides if the pixel has none.
double depth_on(const cv::Mat& depth, const Eigen::Vector2d& pixel, const Eigen::Vector2d& step) {
  const double z = depth_at(depth, pixel);
  if (z > 0.0) return z;
  const double z_left = depth_at(depth, pixel - step);
  const double z_right = depth_at(depth, pixel + step);
  return z_left > 0.0 && z_right > 0.0 ? 0.5 * (z_left + z_right) : 0.0;
}

}  // namespace

LineDepthSamples sample_line_depth(const cv::Mat& depth, const Segment& segment) {
  const int stations = station_count(segment);
  LineDepthSamples result;
  result.owner = find_owner(depth, segment, stations);
  const Eigen::Vector2d step = (result.owner == LineOwner::left ? -1.0 : 1.0) * segment.normal();
  const bool on_segment = result.owner == LineOwner::both;
  const int rows = on_segment ? 1 : 2;
  result.samples.reserve(static_cast<std::size_t>(rows * stations));
  for (int row = 0; row < rows; ++row) {
    const double across = on_segment ? 0.0 : (row == 0 ? kNear : kFar);
    for (int i = 0; i < stations; ++i) {
      const Eigen::Vector2d pixel = segment.at(station_fraction(i, stations)) + across * step;
      const double z = on_segment ? depth_on(depth, pixel, kNear * step) : depth_at(depth, pixel);
      add_sample(result, segment, step, pixel, z);
    }
  }
  return result;
}

}  // namespace eg::features
