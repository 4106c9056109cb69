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

/// Turns blocks into pixels (Feng 2014, section III-D): takes the blocks away at which two regions meet, because they
/// may reach over the crease, and grows the rest pixel by pixel. A pixel joins a region it touches if its error is at
/// most `max_error` times the region's rms error; if several want it, the nearest plane gets it. At most 255 regions.
class RegionGrower {
 public:
  void grow(const BlockGrid& grid, const BlockClusters& clusters, const PlaneTolerance& tolerance, double max_error,
            RegionLabels& result);

 private:
  struct Pixel {
    int u = 0;
    int v = 0;
  };

  void claim_seeds(const BlockGrid& grid, RegionLabels& result);
  void claim_block(const cv::Rect& block, int region, RegionLabels& result);
  void push_edge(const cv::Rect& block, const cv::Mat& labels);

  std::vector<Pixel> frontier_;  ///< pixels whose neighbours are still to be looked at
  cv::Mat errors_;  ///< CV_32FC1, squared error of a pixel under its region's plane, sigma²; 0: not to be claimed
};

}  // namespace eg::features
