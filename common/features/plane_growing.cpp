#include "common/features/plane_growing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace eg::features {
namespace {

constexpr std::array<std::array<int, 2>, 4> kNeighbours{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

/// Blocks whose neighbours inside the image all belong to the same region. A region that would vanish keeps its blocks.
std::vector<int> erode(const BlockGrid& grid, const BlockClusters& clusters) {
  std::vector<int> seeds(clusters.region_of_block.size(), -1);
  std::vector<bool> survives(clusters.regions.size(), false);
  const auto region_at = [&](int column, int row) {
    return clusters.region_of_block[static_cast<std::size_t>(row * grid.columns + column)];
  };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const int region = region_at(column, row);
      if (region < 0) continue;
      const bool inside = (column == 0 || region_at(column - 1, row) == region) &&
                          (column + 1 == grid.columns || region_at(column + 1, row) == region) &&
                          (row == 0 || region_at(column, row - 1) == region) &&
                          (row + 1 == grid.rows || region_at(column, row + 1) == region);
      if (!inside) continue;
      seeds[static_cast<std::size_t>(row * grid.columns + column)] = region;
      survives[static_cast<std::size_t>(region)] = true;
    }
  }
  for (std::size_t block = 0; block < seeds.size(); ++block) {
    const int region = clusters.region_of_block[block];
    if (region >= 0 && !survives[static_cast<std::size_t>(region)]) seeds[block] = region;
  }
  return seeds;
}

}  // namespace

void RegionGrower::claim_seeds(const BlockGrid& grid, RegionLabels& result) {
  frontier_.clear();
  const auto seed_at = [&](int column, int row) {
    return result.seed_of_block[static_cast<std::size_t>(row * grid.columns + column)];
  };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const int region = seed_at(column, row);
      if (region < 0) continue;
      const bool at_boundary = (column > 0 && seed_at(column - 1, row) != region) ||
                               (column + 1 < grid.columns && seed_at(column + 1, row) != region) ||
                               (row > 0 && seed_at(column, row - 1) != region) ||
                               (row + 1 < grid.rows && seed_at(column, row + 1) != region);
      const cv::Rect block = grid.pixels_of(column, row);
      for (int v = block.y; v < block.y + block.height; ++v) {
        const auto* w = grid.inverse_depth.ptr<float>(v);
        auto* label = result.labels.ptr<std::uint8_t>(v);
        auto* error = errors_.ptr<float>(v);
        const bool edge_row = v == block.y || v + 1 == block.y + block.height;
        for (int u = block.x; u < block.x + block.width; ++u) {
          error[u] = 0.0F;  // nobody takes a pixel of a seed
          if (w[u] <= 0.0F) continue;
          label[u] = static_cast<std::uint8_t>(region + 1);
          const bool edge = edge_row || u == block.x || u + 1 == block.x + block.width;
          if (at_boundary && edge) frontier_.push_back(v * grid.inverse_depth.cols + u);
        }
      }
    }
  }
}

void RegionGrower::claim(int u, int v, int region, const BlockGrid& grid, const PlaneTolerance& tolerance,
                         const BlockClusters& clusters, RegionLabels& result) {
  const double w = grid.inverse_depth.ptr<float>(v)[u];
  float& smallest_error = errors_.ptr<float>(v)[u];
  if (w <= 0.0 || smallest_error == 0.0F) return;
  const InverseDepthPlane& plane = clusters.regions[static_cast<std::size_t>(region)].plane;
  const double expected = plane.x() * grid.ray_x[static_cast<std::size_t>(u)] +
                          plane.y() * grid.ray_y[static_cast<std::size_t>(v)] + plane.z();
  const auto error = static_cast<float>(std::abs(w - expected) / std::sqrt(tolerance.variance(w, plane)));
  if (error > limits_[static_cast<std::size_t>(region)] || error >= smallest_error) return;
  smallest_error = error;
  result.labels.ptr<std::uint8_t>(v)[u] = static_cast<std::uint8_t>(region + 1);
  frontier_.push_back(v * grid.inverse_depth.cols + u);
}

void RegionGrower::grow(const BlockGrid& grid, const BlockClusters& clusters, const PlaneTolerance& tolerance,
                        double max_error, RegionLabels& result) {
  const cv::Size size = grid.inverse_depth.size();
  result.labels.create(size, CV_8UC1);
  result.labels.setTo(0);
  errors_.create(size, CV_32FC1);
  errors_.setTo(std::numeric_limits<float>::max());
  result.seed_of_block = erode(grid, clusters);
  claim_seeds(grid, result);
  limits_.clear();
  for (const PlaneRegion& region : clusters.regions) {
    constexpr double kLeastError = 0.5;  // sigma; noise-free images must not stop at rounding errors
    const double error = std::sqrt(region.moments.mean_squared_error(region.plane));
    limits_.push_back(static_cast<float>(max_error * std::max(kLeastError, error)));
  }
  for (std::size_t next = 0; next < frontier_.size(); ++next) {
    const int u = frontier_[next] % size.width;
    const int v = frontier_[next] / size.width;
    const int region = result.labels.ptr<std::uint8_t>(v)[u] - 1;
    for (const auto& [step_u, step_v] : kNeighbours) {
      const int x = u + step_u;
      const int y = v + step_v;
      if (x < 0 || y < 0 || x >= size.width || y >= size.height) continue;
      claim(x, y, region, grid, tolerance, clusters, result);
    }
  }
}

}  // namespace eg::features
