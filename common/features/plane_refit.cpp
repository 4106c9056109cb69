#include "common/features/plane_refit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace eg::features {
namespace {

/// Splits the pixels of one block by label.
class BlockSplitter {
 public:
  explicit BlockSplitter(const BlockGrid& grid) : grid_(grid) {}

  void split(const cv::Rect& pixels, int block, const cv::Mat& labels, std::vector<RegionPatch>& patches) {
    for (int v = pixels.y; v < pixels.y + pixels.height; ++v) {
      const auto* label = labels.ptr<std::uint8_t>(v);
      const auto* w = grid_.inverse_depth.ptr<float>(v);
      for (int u = pixels.x; u < pixels.x + pixels.width; ++u) {
        if (label[u] > 0) patch_of(label[u] - 1, patches).moments.add(ray_x(u), ray_y(v), w[u]);
      }
    }
    for (std::size_t i = patches.size() - used_; i < patches.size(); ++i) {
      weight_by_noise(patches[i].moments);
      patches[i].fitted = used_ == 1;
      patches[i].block = block;
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

/// Sums of the scores in the squares of every size.
class ScoreSums {
 public:
  explicit ScoreSums(int columns) : columns_(columns) {}

  void add(int block, const Eigen::Vector3d& score) {
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const int side = kSquareBlocks[i];
      const int squares_per_row = (columns_ + side - 1) / side;
      const int square = block / columns_ / side * squares_per_row + block % columns_ / side;
      std::vector<Eigen::Vector3d>& sums = sums_[i];
      if (static_cast<std::size_t>(square) >= sums.size()) {
        sums.resize(static_cast<std::size_t>(square) + 1, Eigen::Vector3d::Zero());
      }
      sums[static_cast<std::size_t>(square)] += score;
    }
  }

  [[nodiscard]] std::array<ScoreScatter, kSquareSizes> scatter() const {
    std::array<ScoreScatter, kSquareSizes> result;
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      for (const Eigen::Vector3d& score : sums_[i]) {
        if (score.isZero(0.0)) continue;
        result[i].squares += 1;
        result[i].products += score * score.transpose();
      }
    }
    return result;
  }

 private:
  int columns_;
  std::array<std::vector<Eigen::Vector3d>, kSquareSizes> sums_;
};

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Size of the mean error of a patch's readings under a plane, in standard deviations of one reading.
double mean_error(const RegionPatch& patch, const InverseDepthPlane& plane) {
  const PlaneMoments& m = patch.moments;
  return std::abs(m.score(plane).z()) / std::sqrt(m.weight * m.pixels);
}

/// How far a patch that belongs to the region may be off.
struct TrimLimits {
  double squared_error = 0;
  double mean_error = 0;
};

/// Many times the medians over the region's patches. Noise, the sensor's ripples and whole steps of disparity are in
/// the medians, so what is far above them is another surface: a door behind its wall in whole patches, a frame or a
/// joint in the mean of those it runs through.
TrimLimits trim_limits(const PlaneRegion& region, const std::vector<const RegionPatch*>& patches) {
  constexpr double kManyTimesTheMedian = 6.0;
  constexpr double kAlwaysGood = 0.01;  // sigma²
  constexpr double kSigmas = 3.0;
  constexpr double kSigmaOfMedian = 1.4826;  // of the absolute values of a normal distribution
  if (patches.empty()) return {};
  std::vector<double> squared, means;
  squared.reserve(patches.size());
  means.reserve(patches.size());
  for (const RegionPatch* patch : patches) {
    squared.push_back(patch->moments.mean_squared_error(region.plane));
    means.push_back(mean_error(*patch, region.plane));
  }
  return {std::max(kAlwaysGood, kManyTimesTheMedian * median(squared)),
          std::max(std::sqrt(kAlwaysGood), kSigmas * kSigmaOfMedian * median(means))};
}

/// Takes the patches out of the fit that are much farther off than their region's others.
void trim(const std::vector<PlaneRegion>& regions, std::vector<RegionPatch>& patches) {
  std::vector<std::vector<const RegionPatch*>> fitted(regions.size());
  for (const RegionPatch& patch : patches) {
    if (patch.fitted) fitted[static_cast<std::size_t>(patch.region)].push_back(&patch);
  }
  std::vector<TrimLimits> limits;
  for (std::size_t i = 0; i < regions.size(); ++i) limits.push_back(trim_limits(regions[i], fitted[i]));
  for (RegionPatch& patch : patches) {
    const auto region = static_cast<std::size_t>(patch.region);
    const InverseDepthPlane& plane = regions[region].plane;
    patch.fitted = patch.fitted && patch.moments.mean_squared_error(plane) <= limits[region].squared_error &&
                   mean_error(patch, plane) <= limits[region].mean_error;
  }
}

}  // namespace

void collect_patches(const BlockGrid& grid, const RegionLabels& labels, std::vector<RegionPatch>& patches) {
  patches.clear();
  BlockSplitter splitter(grid);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const int block = row * grid.columns + column;
      const int seed = labels.seed_of_block[static_cast<std::size_t>(block)];
      if (seed >= 0) {
        patches.push_back({seed, grid.moments[static_cast<std::size_t>(block)], true, block});
      } else {
        splitter.split(grid.pixels_of(column, row), block, labels.labels, patches);
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
                                             const std::vector<PlaneRegion>& regions, int columns) {
  std::vector<PlaneScatter> scatters(regions.size());
  std::vector<ScoreSums> sums(regions.size(), ScoreSums(columns));
  for (const RegionPatch& patch : patches) {
    if (patch.region < 0) continue;
    const auto region = static_cast<std::size_t>(patch.region);
    const PlaneMoments& m = patch.moments;
    scatters[region].point_sum += m.pixels * Eigen::Vector3d(m.a, m.b, m.weight) / m.w;
    if (patch.fitted) sums[region].add(patch.block, m.score(regions[region].plane));
  }
  for (std::size_t i = 0; i < regions.size(); ++i) scatters[i].scores = sums[i].scatter();
  return scatters;
}

Eigen::Matrix3d plane_covariance(const PlaneRegion& region, const PlaneScatter& scatter) {
  const Eigen::Matrix3d inverse = region.moments.normal_matrix().inverse();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const ScoreScatter& scores : scatter.scores) {
    constexpr int kEnoughSquares = 8;
    if (scores.squares < kEnoughSquares) continue;
    const double degrees_of_freedom = scores.squares - 3;
    const Eigen::Matrix3d estimate = inverse * scores.products * inverse * (scores.squares / degrees_of_freedom);
    if (estimate.trace() > covariance.trace()) covariance = estimate;
  }
  if (covariance.trace() > 0.0) return covariance;
  // Too few squares to estimate from: as if the noise of each were one single reading.
  return inverse * (region.moments.pixels / std::max(1, scatter.scores.front().squares));
}

Eigen::Matrix3d warp_covariance(const PlaneRegion& region, double warp, double area) {
  const double pixels_per_error = std::min(area, region.moments.pixels);
  return region.moments.normal_matrix().inverse() * (warp * warp * pixels_per_error);
}

}  // namespace eg::features
