#include "common/features/plane_growing.hpp"

#include <algorithm>
#include <limits>

namespace eg::features {
namespace {

/// Calls `visit` with the up to four neighbours of a block.
template <typename Visit>
void for_each_neighbour(const BlockGrid& grid, int column, int row, Visit visit) {
  const int block = row * grid.columns + column;
  if (column > 0) visit(block - 1);
  if (column + 1 < grid.columns) visit(block + 1);
  if (row > 0) visit(block - grid.columns);
  if (row + 1 < grid.rows) visit(block + grid.columns);
}

/// Blocks that do not touch another region. A region without any is a bevel between its neighbours, one block wide,
/// where blocks hold pixels of both: it vanishes, and its pixels go to whom they belong.
std::vector<int> erode(const BlockGrid& grid, const BlockClusters& clusters) {
  std::vector<int> seeds(clusters.region_of_block);
  const auto region_of = [&](int block) { return clusters.region_of_block[static_cast<std::size_t>(block)]; };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const int block = row * grid.columns + column;
      for_each_neighbour(grid, column, row, [&](int other) {
        const bool touches_another = region_of(other) >= 0 && region_of(other) != region_of(block);
        if (touches_another) seeds[static_cast<std::size_t>(block)] = -1;
      });
    }
  }
  return seeds;
}

/// A region's plane in single precision and its limit, for the inner loop.
struct GrowingPlane {
  float x = 0;
  float y = 0;
  float z = 0;
  float lateral_variance = 0;
  float max_squared_error = 0;
  std::uint8_t label = 0;
};

std::vector<GrowingPlane> growing_planes(const std::vector<PlaneRegion>& regions, const PlaneTolerance& tolerance,
                                         double max_error) {
  std::vector<GrowingPlane> planes;
  for (const PlaneRegion& region : regions) {
    constexpr double kLeastSquaredError = 0.25;  // sigma²; images without noise must not stop at rounding errors
    const double squared_error = std::max(kLeastSquaredError, region.moments.mean_squared_error(region.plane));
    planes.push_back(
        {static_cast<float>(region.plane.x()), static_cast<float>(region.plane.y()),
         static_cast<float>(region.plane.z()), static_cast<float>(tolerance.lateral_variance(region.plane)),
         static_cast<float>(max_error * max_error * squared_error), static_cast<std::uint8_t>(planes.size() + 1)});
  }
  return planes;
}

}  // namespace

void RegionGrower::claim_block(const cv::Rect& block, int region, RegionLabels& result) {
  for (int v = block.y; v < block.y + block.height; ++v) {
    auto* label = result.labels.ptr<std::uint8_t>(v);
    auto* error = errors_.ptr<float>(v);
    for (int u = block.x; u < block.x + block.width; ++u) {
      label[u] = error[u] > 0.0F ? static_cast<std::uint8_t>(region + 1) : std::uint8_t{0};
      error[u] = 0.0F;
    }
  }
}

void RegionGrower::push_edge(const cv::Rect& block, const cv::Mat& labels) {
  const int right = block.x + block.width - 1;
  const int bottom = block.y + block.height - 1;
  for (int v = block.y; v <= bottom; ++v) {
    const int step = v == block.y || v == bottom ? 1 : std::max(1, block.width - 1);
    for (int u = block.x; u <= right; u += step) {
      if (labels.ptr<std::uint8_t>(v)[u] > 0) frontier_.push_back({u, v});
    }
  }
}

void RegionGrower::claim_seeds(const BlockGrid& grid, RegionLabels& result) {
  const auto seed_of = [&](int block) { return result.seed_of_block[static_cast<std::size_t>(block)]; };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const int region = seed_of(row * grid.columns + column);
      if (region < 0) continue;
      const cv::Rect block = grid.pixels_of(column, row);
      claim_block(block, region, result);
      bool has_room = false;
      for_each_neighbour(grid, column, row, [&](int other) { has_room = has_room || seed_of(other) < 0; });
      if (has_room) push_edge(block, result.labels);
    }
  }
}

void RegionGrower::grow(const BlockGrid& grid, const BlockClusters& clusters, const PlaneTolerance& tolerance,
                        double max_error, RegionLabels& result) {
  const cv::Size size = grid.inverse_depth.size();
  result.labels.create(size, CV_8UC1);
  result.labels.setTo(0);
  errors_.create(size, CV_32FC1);
  for (int v = 0; v < size.height; ++v) {
    const auto* w = grid.inverse_depth.ptr<float>(v);
    auto* error = errors_.ptr<float>(v);
    for (int u = 0; u < size.width; ++u) error[u] = w[u] > 0.0F ? std::numeric_limits<float>::max() : 0.0F;
  }
  result.seed_of_block = erode(grid, clusters);
  frontier_.clear();
  claim_seeds(grid, result);

  const std::vector<GrowingPlane> planes = growing_planes(clusters.regions, tolerance, max_error);
  const auto claim = [&](int u, int v, const GrowingPlane& plane) {
    std::uint8_t& label = result.labels.ptr<std::uint8_t>(v)[u];
    float& smallest_error = errors_.ptr<float>(v)[u];
    if (label == plane.label || smallest_error == 0.0F) return;
    const float w = grid.inverse_depth.ptr<float>(v)[u];
    const auto x = static_cast<float>(grid.ray_x[static_cast<std::size_t>(u)]);
    const auto y = static_cast<float>(grid.ray_y[static_cast<std::size_t>(v)]);
    const float difference = w - (plane.x * x + plane.y * y + plane.z);
    const auto sigma = static_cast<float>(inverse_depth_sigma(w));
    const float variance = sigma * sigma + plane.lateral_variance;
    const float error = difference * difference / variance;
    if (error > plane.max_squared_error || error >= smallest_error) return;
    label = plane.label;
    smallest_error = std::max(error, std::numeric_limits<float>::min());
    frontier_.push_back({u, v});
  };
  for (std::size_t next = 0; next < frontier_.size(); ++next) {
    const auto [u, v] = frontier_[next];
    const GrowingPlane& plane = planes[result.labels.ptr<std::uint8_t>(v)[u] - 1U];
    if (u > 0) claim(u - 1, v, plane);
    if (u + 1 < size.width) claim(u + 1, v, plane);
    if (v > 0) claim(u, v - 1, plane);
    if (v + 1 < size.height) claim(u, v + 1, plane);
  }
}

}  // namespace eg::features
