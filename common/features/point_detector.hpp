#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace eg::features {

struct PointDetectorOptions {
  int max_points = 1000;      ///< kept per frame; shared out over the levels by their area
  int levels = 8;             ///< of the image pyramid
  double scale_factor = 1.2;  ///< between levels
  int fast_threshold = 7;     ///< smallest grey level difference of a FAST corner; stronger corners go first
  int cell_size = 32;         ///< pixels, of the grid that spreads the points, on every level
};

/// FAST corners (Rosten and Drummond, ECCV 2006) on an image pyramid, spread over the image: the best corner of every
/// grid cell comes before the second best of any, so that corners of weak texture survive beside strong ones. Corners
/// are then located to a fraction of a pixel (Förstner and Gülch, ISPRS 1987). `pt` is in pixels of the pyramid level
/// `octave`; `size` is the patch's diameter in the full image; `angle` (degrees) points
/// to the intensity centroid (Rublee et al., ICCV 2011). Sorted by level, then by rank. The image is CV_8UC1.
std::vector<cv::KeyPoint> detect_corners(const cv::Mat& grey, const PointDetectorOptions& options);

}  // namespace eg::features
