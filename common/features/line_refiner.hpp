#pragma once

#include <opencv2/core/mat.hpp>

#include "common/features/line_segment.hpp"

namespace eg::features {

/// The segment moved onto the edge with sub-pixel accuracy: the gradient's peak across the segment is found at many
/// stations along it (parabola through the three highest of its samples), and a line is fitted to the peaks by robust
/// least squares. Detectors fit lines to whole pixels; this removes their bias, measures `sigma` from the scatter of
/// the peaks, and turns the segment so that its brighter side is on the right. Where too few stations show a peak, the
/// position stays and `sigma` is that of a detector. The image is CV_8UC1.
Segment refine_segment(const cv::Mat& grey, const Segment& segment);

}  // namespace eg::features
