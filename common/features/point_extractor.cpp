#include "common/features/point_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/features2d.hpp>

#include "common/base/check.hpp"
#include "common/features/point_depth.hpp"

namespace eg::features {
namespace {

/// Rotated BRIEF of every corner, one row each. OpenCV wants the corners in units of the full image.
cv::Mat describe(const cv::Mat& grey, std::vector<cv::KeyPoint> corners, const PointDetectorOptions& options) {
  constexpr int kPatchSize = 31;
  constexpr int kEdgeThreshold = kPatchSize / 2;  // below the detector's border: drops no corner
  const auto scale_factor = static_cast<float>(options.scale_factor);
  for (cv::KeyPoint& corner : corners) corner.pt *= std::pow(scale_factor, static_cast<float>(corner.octave));

  const auto orb = cv::ORB::create(options.max_points, scale_factor, options.levels, kEdgeThreshold, 0, 2,
                                   cv::ORB::HARRIS_SCORE, kPatchSize);
  const auto count = corners.size();
  cv::Mat descriptors;
  orb->compute(grey, corners, descriptors);
  EG_CHECK(corners.size() == count && descriptors.rows == static_cast<int>(count), "ORB keeps the corners it is given");
  return descriptors;
}

/// Pixel of the full image of a pyramid level's pixel: pixel areas correspond, so centres are half a pixel off corners.
Eigen::Vector2d to_full_image(const cv::Point2f& point, double scale) {
  return {(point.x + 0.5) * scale - 0.5, (point.y + 0.5) * scale - 0.5};
}

PointFeature make_point(const cv::KeyPoint& corner, const std::uint8_t* descriptor, const cv::Mat& depth,
                        const PointExtractorOptions& options) {
  const double scale = std::pow(options.detector.scale_factor, corner.octave);
  PointFeature point;
  point.pixel = to_full_image(corner.pt, scale);
  point.pixel_sigma = options.pixel_sigma * scale;
  point.angle = corner.angle * std::numbers::pi / 180.0;
  point.octave = corner.octave;
  std::copy_n(descriptor, point.descriptor.size(), point.descriptor.begin());

  const DepthReading reading = read_depth(depth, cvRound(point.pixel.x()), cvRound(point.pixel.y()));
  point.depth = reading.depth;
  point.depth_sigma = reading.sigma;
  return point;
}

}  // namespace

base::Status validate(const PointExtractorOptions& options) {
  const PointDetectorOptions& detector = options.detector;
  if (detector.max_points < 0 || detector.max_points > kMaxPoints) {
    return base::fail("points.max_points must be in 0.." + std::to_string(kMaxPoints));
  }
  if (detector.levels < 1 || detector.levels > 16) return base::fail("points.levels must be in 1..16");
  if (!(detector.scale_factor > 1.0 && detector.scale_factor <= 2.0)) {
    return base::fail("points.scale_factor must be above 1 and at most 2");
  }
  if (detector.fast_threshold < 1 || detector.fast_threshold > 255) {
    return base::fail("points.fast_threshold must be in 1..255");
  }
  if (detector.cell_size < 8) return base::fail("points.cell_size must be at least 8 pixels");
  if (!(options.pixel_sigma > 0.0)) return base::fail("points.pixel_sigma must be positive");
  return {};
}

std::vector<PointFeature> extract_points(const cv::Mat& grey, const cv::Mat& depth,
                                         const PointExtractorOptions& options) {
  EG_CHECK(grey.empty() || grey.type() == CV_8UC1, "grey is 8 bit, one channel");
  EG_CHECK(depth.empty() || depth.type() == CV_32FC1, "depth is in metres");
  EG_CHECK(grey.size() == depth.size(), "grey and depth have one size");
  if (grey.empty()) return {};

  const std::vector<cv::KeyPoint> corners = detect_corners(grey, options.detector);
  std::vector<PointFeature> points;
  if (corners.empty()) return points;
  const cv::Mat descriptors = describe(grey, corners, options.detector);
  points.reserve(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    points.push_back(make_point(corners[i], descriptors.ptr(static_cast<int>(i)), depth, options));
  }
  return points;
}

}  // namespace eg::features
