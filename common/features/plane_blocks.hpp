#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/features/plane_extraction.hpp"
#include "common/features/plane_moments.hpp"
#include "common/features/plane_tolerance.hpp"
#include "common/geometry/camera_model.hpp"

namespace eg::features {

/// The depth image cut into square blocks, with the moments of each: the nodes of the block graph.
struct BlockGrid {
  int block_size = 0;
  int columns = 0;
  int rows = 0;
  std::vector<double> ray_x;          ///< x/z of every image column
  std::vector<double> ray_y;          ///< y/z of every image row
  cv::Mat inverse_depth;              ///< CV_32FC1, 1/m, 0 where there is no reading
  std::vector<PlaneMoments> moments;  ///< of every block, row by row; weighted by the sensor's noise
  std::vector<PlaneFit> fits;         ///< invalid: the block has too few readings or is not flat

  [[nodiscard]] int block_count() const { return columns * rows; }
  [[nodiscard]] cv::Rect pixels_of(int column, int row) const;
};

/// Side of the blocks that an image of this size is cut into, pixels.
int block_size_of(const PlaneOptions& options, const cv::Size& image);

/// Fills `grid` from a depth image in metres.
void build_blocks(const cv::Mat& depth, const geometry::CameraModel& camera, const PlaneOptions& options,
                  const PlaneTolerance& tolerance, BlockGrid& grid);

/// Gives moments of unweighted pixels that lie at about one depth the weight 1/sigma².
void weight_by_noise(PlaneMoments& moments);

}  // namespace eg::features
