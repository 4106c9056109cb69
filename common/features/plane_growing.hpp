#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/features/plane_clustering.hpp"

namespace eg::features {

/// The pixels of every region.
struct RegionLabels {
  cv::Mat labels;                  ///< CV_8UC1, 0 none, i + 1 region i
  std::vector<int> seed_of_block;  ///< region that owns all of a block's readings; -1: look at the pixels
};

/// Turns blocks into pixels (Feng 2014, section III-D): takes the blocks at a region's boundary away, because they may
/// reach over it, and grows the rest pixel by pixel. A pixel joins a region it touches if its error is at most
/// `max_error` times the region's rms error; if several want it, the nearest plane gets it. At most 255 regions.
class RegionGrower {
 public:
  void grow(const BlockGrid& grid, const BlockClusters& clusters, const PlaneTolerance& tolerance, double max_error,
            RegionLabels& result);

 private:
  void claim_seeds(const BlockGrid& grid, RegionLabels& result);
  void claim(int u, int v, int region, const BlockGrid& grid, const PlaneTolerance& tolerance,
             const BlockClusters& clusters, RegionLabels& result);

  std::vector<int> frontier_;  ///< pixels whose neighbours are still to be looked at
  std::vector<float> limits_;  ///< largest error of a pixel that joins, per region, sigma
  cv::Mat errors_;             ///< CV_32FC1, error of a pixel under its region's plane, sigma
};

}  // namespace eg::features
