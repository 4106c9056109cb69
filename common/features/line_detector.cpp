#include "common/features/line_detector.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/edge_drawing.hpp>

namespace eg::features {
namespace {

constexpr int kMinImageSide = 16;
constexpr double kBrokenShare = 0.5;  // broken pieces this short may still add up to a segment that is long enough

std::vector<cv::Vec4f> run_lsd(const cv::Mat& grey) {
  std::vector<cv::Vec4f> lines;
  cv::createLineSegmentDetector(cv::LSD_REFINE_STD)->detect(grey, lines);
  return lines;
}

std::vector<cv::Vec4f> run_edlines(cv::ximgproc::EdgeDrawing& detector, const cv::Mat& grey, double min_length) {
  cv::ximgproc::EdgeDrawing::Params parameters;
  parameters.EdgeDetectionOperator = cv::ximgproc::EdgeDrawing::SOBEL;
  parameters.GradientThresholdValue = 20;
  parameters.MinLineLength = static_cast<int>(min_length);
  detector.setParams(parameters);
  detector.detectEdges(grey);
  std::vector<cv::Vec4f> lines;
  detector.detectLines(lines);
  return lines;
}

}  // namespace

double min_segment_length(const cv::Size& image, const LineDetectorOptions& options) {
  return options.min_length * std::hypot(image.width, image.height);
}

LineDetector::LineDetector(const LineDetectorOptions& options) : options_(options) {
  if (options_.kind == LineDetectorKind::edlines) edge_drawing_ = cv::ximgproc::createEdgeDrawing();
}

std::vector<Segment> LineDetector::detect(const cv::Mat& grey) {
  if (std::min(grey.rows, grey.cols) < kMinImageSide) return {};
  const double min_length = kBrokenShare * min_segment_length(grey.size(), options_);
  const std::vector<cv::Vec4f> lines =
      edge_drawing_ != nullptr ? run_edlines(*edge_drawing_, grey, min_length) : run_lsd(grey);

  std::vector<Segment> segments;
  segments.reserve(lines.size());
  for (const cv::Vec4f& line : lines) {
    const Segment segment{{line[0], line[1]}, {line[2], line[3]}};
    if (segment.length() >= min_length) segments.push_back(segment);
  }
  return segments;
}

}  // namespace eg::features
