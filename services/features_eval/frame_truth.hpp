#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/plane.hpp"
#include "common/synthetic/sequence.hpp"
#include "common/synthetic/structure.hpp"

namespace eg::features_eval {

/// What should be found in one frame of a synthetic sequence, in the camera frame.
struct FrameTruth {
  std::vector<geometry::Plane> planes;
  std::vector<int> plane_pixels;                 ///< how many depth readings show each plane
  cv::Mat plane_of_pixel;                        ///< CV_16SC1, index into planes; -1: none, or no reading
  std::vector<Eigen::Vector3d> parallel_groups;  ///< directions of at least kGroupEdges long visible edges
  std::vector<Eigen::Vector3d> directions;       ///< all directions of visible edges and of what is painted on surfaces

  static constexpr int kGroupEdges = 3;
  static constexpr double kLongEdge = 0.05;  ///< of the image's diagonal
};

/// `depth` (CV_32FC1, 0: no reading) is what the sensor made of the frame.
FrameTruth frame_truth(const synthetic::SyntheticSequence& sequence, const synthetic::SceneStructure& structure,
                       int index, const cv::Mat& depth);

}  // namespace eg::features_eval
