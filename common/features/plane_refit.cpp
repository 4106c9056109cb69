#include "common/features/plane_refit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cstdint>

namespace eg::features {
namespace {

constexpr int kClusterBlocks =
    3;  // on a side of a cluster: disparity in whole steps correlates errors over some blocks

/// Splits the pixels of one block by label.
class BlockSplitter {
 public:
  explicit BlockSplitter(const BlockGrid& grid) : grid_(grid) {}

  void split(const cv::Rect& block, int cluster, const cv::Mat& labels, std::vector<RegionPatch>& patches) {
    for (int v = block.y; v < block.y + block.height; ++v) {
      const auto* label = labels.ptr<std::uint8_t>(v);
      const auto* w = grid_.inverse_depth.ptr<float>(v);
      for (int u = block.x; u < block.x + block.width; ++u) {
        if (label[u] > 0) patch_of(label[u] - 1, patches).moments.add(ray_x(u), ray_y(v), w[u]);
      }
    }
    for (std::size_t i = patches.size() - used_; i < patches.size(); ++i) {
      weight_by_noise(patches[i].moments);
      patches[i].fitted = used_ == 1;
      patches[i].cluster = cluster;
    }
    used_ = 0;
  }

 private:
  [[nodiscard]] double ray_x(int u) const { return grid_.ray_x[static_cast<std::size_t>(u)]; }
  [[nodiscard]] double ray_y(int v) const { return grid_.ray_y[static_cast<std::size_t>(v)]; }

  /// This block's patch of a region: one of the last `used_`.
  RegionPatch& patch_of(int region, std::vector<RegionPatch>& patches) {
    for (std::size_t i = patches.size() - used_; i < patches.size(); ++i) {
      if (patches[i].region == region) return patches[i];
    }
    ++used_;
    return patches.emplace_back(RegionPatch{region, {}, true, 0});
  }

  const BlockGrid& grid_;
  std::size_t used_ = 0;
};

std::vector<PlaneRegion> fit_regions(const std::vector<RegionPatch>& patches, std::size_t count) {
  std::vector<PlaneRegion> regions(count);
  std::vector<PlaneMoments> others(count);
  for (const RegionPatch& patch : patches) {
    const auto i = static_cast<std::size_t>(patch.region);
    (patch.fitted ? regions[i].moments : others[i]) += patch.moments;
    regions[i].support += patch.moments.pixels;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!fit_plane(regions[i].moments).valid) regions[i].moments += others[i];
    regions[i].fit();
  }
  return regions;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Takes the patches out of the fit whose squared error is far above the median of their region.
void trim(const std::vector<PlaneRegion>& regions, std::vector<RegionPatch>& patches) {
  constexpr double kManyTimesTheMedian = 6.0;
  constexpr double kAlwaysGood = 0.01;  // sigma²
  std::vector<std::vector<double>> errors(regions.size());
  const auto error_of = [&](const RegionPatch& patch) {
    return patch.moments.mean_squared_error(regions[static_cast<std::size_t>(patch.region)].plane);
  };
  for (const RegionPatch& patch : patches) {
    if (patch.fitted) errors[static_cast<std::size_t>(patch.region)].push_back(error_of(patch));
  }
  std::vector<double> limits;
  for (std::vector<double>& of_region : errors) {
    limits.push_back(of_region.empty() ? 0.0 : std::max(kAlwaysGood, kManyTimesTheMedian * median(of_region)));
  }
  for (RegionPatch& patch : patches) {
    patch.fitted = patch.fitted && error_of(patch) <= limits[static_cast<std::size_t>(patch.region)];
  }
}

}  // namespace

void collect_patches(const BlockGrid& grid, const RegionLabels& labels, std::vector<RegionPatch>& patches) {
  patches.clear();
  BlockSplitter splitter(grid);
  const int clusters_per_row = (grid.columns + kClusterBlocks - 1) / kClusterBlocks;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const auto block = static_cast<std::size_t>(row * grid.columns + column);
      const int cluster = row / kClusterBlocks * clusters_per_row + column / kClusterBlocks;
      if (labels.seed_of_block[block] >= 0) {
        patches.push_back({labels.seed_of_block[block], grid.moments[block], true, cluster});
      } else {
        splitter.split(grid.pixels_of(column, row), cluster, labels.labels, patches);
      }
    }
  }
}

std::vector<PlaneRegion> refit_regions(std::vector<RegionPatch>& patches, int count) {
  std::vector<PlaneRegion> regions = fit_regions(patches, static_cast<std::size_t>(count));
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    trim(regions, patches);
    regions = fit_regions(patches, regions.size());
  }
  return regions;
}

std::vector<PlaneScatter> scatter_of_regions(const std::vector<RegionPatch>& patches,
                                             const std::vector<PlaneRegion>& regions) {
  std::vector<PlaneScatter> scatters(regions.size());
  std::vector<std::vector<Eigen::Vector3d>> scores(regions.size());  // by cluster
  for (const RegionPatch& patch : patches) {
    if (patch.region < 0) continue;
    const auto region = static_cast<std::size_t>(patch.region);
    const auto cluster = static_cast<std::size_t>(patch.cluster);
    const PlaneMoments& m = patch.moments;
    scatters[region].point_sum += m.pixels * Eigen::Vector3d(m.a, m.b, m.weight) / m.w;
    if (!patch.fitted) continue;
    if (cluster >= scores[region].size()) scores[region].resize(cluster + 1, Eigen::Vector3d::Zero());
    scores[region][cluster] += m.score(regions[region].plane);
  }
  for (std::size_t i = 0; i < regions.size(); ++i) {
    for (const Eigen::Vector3d& score : scores[i]) {
      if (score.isZero(0.0)) continue;
      scatters[i].clusters += 1;
      scatters[i].scores += score * score.transpose();
    }
  }
  return scatters;
}

Eigen::Matrix3d plane_covariance(const PlaneRegion& region, const PlaneScatter& scatter) {
  const Eigen::Matrix3d inverse = region.moments.normal_matrix().inverse();
  constexpr int kEnoughClusters = 8;
  if (scatter.clusters < kEnoughClusters) {
    // Too few to estimate from: as if the noise of each block were one single reading.
    return inverse * (region.moments.pixels / std::max(1, scatter.clusters));
  }
  const double degrees_of_freedom = scatter.clusters - 3;
  return inverse * scatter.scores * inverse * (scatter.clusters / degrees_of_freedom);
}

Eigen::Matrix3d warp_covariance(const PlaneRegion& region, double warp, double area) {
  const double pixels_per_error = std::min(area, region.moments.pixels);
  return region.moments.normal_matrix().inverse() * (warp * warp * pixels_per_error);
}

}  // namespace eg::features
