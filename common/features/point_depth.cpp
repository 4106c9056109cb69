#include "common/features/point_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/depth_noise.hpp"

namespace eg::features {
namespace {

constexpr int kMinReadings = 3;

bool is_reading(float z) { return std::isfinite(z) && z > 0.0F; }

}  // namespace

DepthReading read_depth(const cv::Mat& depth, int x, int y) {
  if (x < 1 || y < 1 || x >= depth.cols - 1 || y >= depth.rows - 1) return {};

  std::array<float, 9> readings{};
  int count = 0;
  for (int v = y - 1; v <= y + 1; ++v) {
    const auto* row = depth.ptr<float>(v);
    for (int u = x - 1; u <= x + 1; ++u) {
      if (is_reading(row[u])) readings[static_cast<std::size_t>(count++)] = row[u];
    }
  }
  if (count < kMinReadings) return {};

  const double nearest = *std::min_element(readings.begin(), readings.begin() + count);
  const double limit = nearest + depth_jump(nearest);
  double sum = 0.0;
  int near_count = 0;
  for (int i = 0; i < count; ++i) {
    const double z = readings[static_cast<std::size_t>(i)];
    if (z > limit) continue;
    sum += z;
    ++near_count;
  }
  if (near_count < kMinReadings) return {};

  const float centre = depth.at<float>(y, x);
  const double z = is_reading(centre) && centre <= limit ? centre : sum / near_count;
  return {z, geometry::depth_sigma(z)};
}

}  // namespace eg::features
