#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/features/line_segment.hpp"

namespace eg::features {

enum class LineDetectorKind {
  lsd,      ///< LSD: von Gioi, Jakubowicz, Morel, Randall, PAMI 2010
  edlines,  ///< EDLines: Akinlar and Topal, Pattern Recognition Letters 2011
};

struct LineDetectorOptions {
  LineDetectorKind kind = LineDetectorKind::edlines;  ///< three times faster here, and as accurate once refined
  double min_length = 0.034;                          ///< of a segment, as a share of the image's diagonal
};

/// Shortest segment (pixels) that the options ask for in an image of this size.
double min_segment_length(const cv::Size& image, const LineDetectorOptions& options);

/// Straight segments of an image (CV_8UC1), as the detector finds them, in its order. None in an image that is smaller
/// than 16 pixels on a side.
std::vector<Segment> detect_segments(const cv::Mat& grey, const LineDetectorOptions& options);

}  // namespace eg::features
