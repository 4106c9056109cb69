#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "common/features/plane_growing.hpp"

namespace eg::features {

/// The part of a region that lies in one block.
struct RegionPatch {
  int region = 0;
  PlaneMoments moments;  ///< weighted by the sensor's noise
  bool fitted = true;    ///< whether the region's plane is fitted to it; else it only counts as support
  int block = 0;         ///< of the grid
};

/// Every region's patches, block by block. Whole blocks reuse the block's moments; only blocks with a boundary are read
/// again.
void collect_patches(const BlockGrid& grid, const RegionLabels& labels, std::vector<RegionPatch>& patches);

/// Regions 0 to `count` - 1 with the planes that fit their pixels, but for two kinds of patches, which it marks.
/// Patches beside other regions: at a crease a pixel goes to the plane that its noise takes it to, and such a choice
/// would bias the planes. And patches that are much worse than the region's median: a door a little behind its wall.
std::vector<PlaneRegion> refit_regions(std::vector<RegionPatch>& patches, int count);

/// What neighbouring pixels share of their errors reaches some blocks far: disparity in whole steps, pieces of another
/// surface a little before or behind. So parts of the image count as independent, squares of so many blocks on a side.
inline constexpr std::array kSquareBlocks = {3, 6, 12};
inline constexpr std::size_t kSquareSizes = kSquareBlocks.size();

/// Scores of the squares of one size.
struct ScoreScatter {
  int squares = 0;                                     ///< that the plane is fitted to
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();  ///< sum of score · scoreᵀ over them
};

/// Sums that the covariance of one region's plane is made of.
struct PlaneScatter {
  std::array<ScoreScatter, kSquareSizes> scores;
  Eigen::Vector3d point_sum = Eigen::Vector3d::Zero();  ///< sum of the pixels' points, metres
};

/// `columns`: of the block grid.
std::vector<PlaneScatter> scatter_of_regions(const std::vector<RegionPatch>& patches,
                                             const std::vector<PlaneRegion>& regions, int columns);

/// Covariance of a fitted inverse-depth plane that holds for noise of any size that is correlated over less than a
/// square: the cluster-robust ("sandwich") estimate of Liang and Zeger, Biometrika 1986, with squares of blocks as
/// clusters. How far the correlation reaches is not known: the size of squares with the largest estimate decides.
Eigen::Matrix3d plane_covariance(const PlaneRegion& region, const PlaneScatter& scatter);

/// Covariance by errors of `warp` standard deviations that `area` pixels share, and that the scatter within the region
/// does not show in full, because the fit takes their tilt for the plane's.
Eigen::Matrix3d warp_covariance(const PlaneRegion& region, double warp, double area);

}  // namespace eg::features
