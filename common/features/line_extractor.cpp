#include "common/features/line_extractor.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "common/base/check.hpp"
#include "common/features/line_descriptor.hpp"
#include "common/features/line_refiner.hpp"

namespace eg::features {
namespace {

MeasuredLine measure(const Segment& segment, const cv::Mat& depth, const GradientImages& gradients,
                     const geometry::CameraModel& camera, const LineLifterOptions& options, std::uint64_t seed) {
  MeasuredLine line;
  line.segment = segment;
  line.feature.start_pixel = segment.start;
  line.feature.end_pixel = segment.end;
  line.feature.descriptor = describe_segment(gradients, segment);
  if (const auto lifted = lift_line(segment, depth, camera, options, seed)) {
    line.feature.has_depth = true;
    line.feature.start = lifted->start;
    line.feature.end = lifted->end;
    line.feature.start_covariance = lifted->start_covariance;
    line.feature.end_covariance = lifted->end_covariance;
    line.direction = lifted->direction;
    line.direction_sigma = lifted->direction_sigma;
  }
  return line;
}

/// Whether a segment runs along the border of the image, where many cameras' images end in a dark seam; it would move
/// with the camera.
bool is_seam(const Segment& segment, const cv::Size& image) {
  constexpr double kWidth = 4.0;  // pixels; nearer to the border a segment cannot be refined either
  const auto along = [](double a, double b, int side) {
    return std::max(a, b) < kWidth || std::min(a, b) > side - 1 - kWidth;
  };
  return along(segment.start.x(), segment.end.x(), image.width) ||
         along(segment.start.y(), segment.end.y(), image.height);
}

}  // namespace

base::Status validate(const LineExtractorOptions& options) {
  if (options.max_lines < 0 || options.max_lines > kMaxLines) {
    return base::fail("lines.max_lines must be in 0.." + std::to_string(kMaxLines));
  }
  if (!(options.detector.min_length > 0.0 && options.detector.min_length < 1.0)) {
    return base::fail("lines.min_length must be between 0 and 1");
  }
  if (!(options.merger.max_offset >= 0.0 && options.merger.max_gap >= 0.0 && options.merger.max_gap_share >= 0.0)) {
    return base::fail("lines.merge limits must not be negative");
  }
  const LineLifterOptions& lifter = options.lifter;
  if (lifter.min_inliers < 3) return base::fail("lines.min_inliers must be at least 3");
  if (!(lifter.min_inlier_ratio > 0.0 && lifter.min_inlier_ratio <= 1.0)) {
    return base::fail("lines.min_inlier_ratio must be above 0 and at most 1");
  }
  if (!(lifter.min_coverage > 0.0 && lifter.min_coverage <= 1.0)) {
    return base::fail("lines.min_coverage must be above 0 and at most 1");
  }
  if (!(lifter.inlier_sigmas > 0.0)) return base::fail("lines.inlier_sigmas must be positive");
  if (lifter.max_iterations < 1) return base::fail("lines.max_iterations must be positive");
  return {};
}

LineExtractor::LineExtractor(const LineExtractorOptions& options) : options_(options), detector_(options.detector) {}

std::vector<Segment> LineExtractor::find_segments(const cv::Mat& grey) {
  std::vector<Segment> segments = detector_.detect(grey);
  for (Segment& segment : segments) segment = refine_segment(grey, segment);
  const std::size_t pieces = segments.size();
  segments = merge_collinear(std::move(segments), options_.merger);
  const double min_length = min_segment_length(grey.size(), options_.detector);
  std::erase_if(segments,
                [&](const Segment& segment) { return segment.length() < min_length || is_seam(segment, grey.size()); });
  segments.resize(std::min(segments.size(), static_cast<std::size_t>(options_.max_lines)));
  if (segments.size() < pieces) {
    for (Segment& segment : segments) segment = refine_segment(grey, segment);
  }
  return segments;
}

std::vector<MeasuredLine> LineExtractor::extract(const cv::Mat& grey, const cv::Mat& depth,
                                                 const geometry::CameraModel& camera) {
  EG_CHECK(grey.empty() || grey.type() == CV_8UC1, "grey is 8 bit, one channel");
  EG_CHECK(depth.empty() || depth.type() == CV_32FC1, "depth is in metres");
  EG_CHECK(grey.size() == depth.size(), "grey and depth have one size");
  std::vector<MeasuredLine> lines;
  if (grey.empty()) return lines;

  const std::vector<Segment> segments = find_segments(grey);
  if (segments.empty()) return lines;
  compute_gradients(grey, gradients_);
  lines.reserve(segments.size());
  for (const Segment& segment : segments) {
    lines.push_back(measure(segment, depth, gradients_, camera, options_.lifter, options_.seed + lines.size()));
  }
  return lines;
}

std::vector<MeasuredLine> extract_lines(const cv::Mat& grey, const cv::Mat& depth, const geometry::CameraModel& camera,
                                        const LineExtractorOptions& options) {
  return LineExtractor(options).extract(grey, depth, camera);
}

}  // namespace eg::features
