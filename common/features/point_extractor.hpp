#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/base/result.hpp"
#include "common/features/features.hpp"
#include "common/features/point_detector.hpp"

namespace eg::features {

struct PointExtractorOptions {
  PointDetectorOptions detector;
  double pixel_sigma = 1.0;  ///< standard deviation per axis of a corner on the finest level, pixels
};

/// Names the first option that is out of range.
base::Status validate(const PointExtractorOptions& options);

/// ORB points (Rublee, Rabaud, Konolige, Bradski, ICCV 2011) spread over the image, with the depth at their pixel where
/// the depth image can be trusted there. `grey` is CV_8UC1, `depth` is CV_32FC1 in metres, both undistorted and of one
/// size. The result depends on the arguments only, in a fixed order: by octave, strongest of each image cell first.
std::vector<PointFeature> extract_points(const cv::Mat& grey, const cv::Mat& depth,
                                         const PointExtractorOptions& options = {});

}  // namespace eg::features
