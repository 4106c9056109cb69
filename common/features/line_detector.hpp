#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/features/line_segment.hpp"

namespace cv::ximgproc {
class EdgeDrawing;
}

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

/// Finds straight segments. Keeps OpenCV's EdgeDrawing, because every object of that class leaks some memory
/// (OpenCV 4.6); results depend on the image alone. One object per thread.
class LineDetector {
 public:
  explicit LineDetector(const LineDetectorOptions& options = {});

  /// The segments of an image (CV_8UC1), as the detector finds them, in its order. None in an image that is smaller
  /// than 16 pixels on a side.
  [[nodiscard]] std::vector<Segment> detect(const cv::Mat& grey);

 private:
  LineDetectorOptions options_;
  std::shared_ptr<cv::ximgproc::EdgeDrawing> edge_drawing_;  ///< none for LSD
};

}  // namespace eg::features
