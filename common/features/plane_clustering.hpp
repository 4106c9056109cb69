#pragma once

#include <vector>

#include "common/features/plane_blocks.hpp"

namespace eg::features {

/// A set of pixels on one plane.
struct PlaneRegion {
  PlaneMoments moments;
  InverseDepthPlane plane = InverseDepthPlane::Zero();
};

/// Regions, and to which of them each block belongs.
struct BlockClusters {
  std::vector<PlaneRegion> regions;  ///< by falling number of pixels
  std::vector<int> region_of_block;  ///< index into regions; -1: none
};

/// Clusters the blocks bottom-up: while there are neighbours whose union is flat, merges the pair whose union has the
/// smallest mean squared error. Regions under `min_pixels` are dropped, and no more than `max_regions` are kept.
BlockClusters cluster_blocks(const BlockGrid& grid, double max_merge_error, double min_pixels, int max_regions);

/// Joins regions that lie on one plane wherever they are in the image (a wall behind a pillar). Returns the new index
/// of each old region; `regions` comes back shortened and by falling number of pixels.
std::vector<int> merge_coplanar(std::vector<PlaneRegion>& regions, double max_error);

}  // namespace eg::features
