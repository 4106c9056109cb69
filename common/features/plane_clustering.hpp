#pragma once

#include <optional>
#include <vector>

#include "common/features/plane_blocks.hpp"
#include "common/features/plane_tolerance.hpp"

namespace eg::features {

/// A set of pixels on one plane.
struct PlaneRegion {
  PlaneMoments moments;  ///< of the pixels that its plane is fitted to
  InverseDepthPlane plane = InverseDepthPlane::Zero();
  double mean_squared_error = 0;  ///< of those pixels
  double support = 0;             ///< number of pixels that belong to it

  /// Fits the plane to the moments.
  void fit() {
    const PlaneFit fitted = fit_plane(moments);
    plane = fitted.plane;
    mean_squared_error = fitted.mean_squared_error;
  }

  void join(const PlaneRegion& other) {
    moments += other.moments;
    support += other.support;
    fit();
  }
};

/// Regions, and to which of them each block belongs.
struct BlockClusters {
  std::vector<PlaneRegion> regions;  ///< by falling number of pixels
  std::vector<int> region_of_block;  ///< index into regions; -1: none
};

/// Clusters the blocks bottom-up: while there are neighbours whose union is flat, merges the pair whose union has the
/// smallest mean squared error. Regions under `min_pixels` are dropped, and no more than `max_regions` are kept.
BlockClusters cluster_blocks(const BlockGrid& grid, const PlaneTolerance& tolerance, double min_pixels,
                             int max_regions);

/// The plane of the union of two regions, unless one of them does not fit it.
std::optional<PlaneFit> fit_union(const PlaneRegion& left, const PlaneRegion& right, const PlaneTolerance& tolerance);

}  // namespace eg::features
