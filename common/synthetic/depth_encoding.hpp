#pragma once

#include <opencv2/core/mat.hpp>

namespace eg::synthetic {

/// Depth in metres (CV_32FC1) as a sensor stores it: CV_16UC1 with the given units per metre, 0 for no reading and for
/// depths beyond the largest 16-bit number.
cv::Mat encode_depth(const cv::Mat& depth_metres, double units_per_metre);

/// The reverse: metres, 0 where there is no reading.
cv::Mat decode_depth(const cv::Mat& depth, double units_per_metre);

}  // namespace eg::synthetic
