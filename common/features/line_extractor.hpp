#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/base/result.hpp"
#include "common/features/features.hpp"
#include "common/features/line_descriptor.hpp"
#include "common/features/line_detector.hpp"
#include "common/features/line_lifter.hpp"
#include "common/features/line_merger.hpp"
#include "common/features/line_segment.hpp"
#include "common/geometry/camera_model.hpp"

namespace eg::features {

struct LineExtractorOptions {
  LineDetectorOptions detector;
  LineMergerOptions merger;
  LineLifterOptions lifter;
  int max_lines = 300;  ///< the longest are kept
  std::uint64_t seed = 1;
};

/// Names the first option that is out of range.
base::Status validate(const LineExtractorOptions& options);

/// A line feature with what the estimation of directions needs beyond it.
struct MeasuredLine {
  LineFeature feature;                                  ///< `direction` is not set yet
  Segment segment;                                      ///< the feature's pixels with their noise
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< unit, start to end, camera frame; if feature.has_depth
  double direction_sigma = 0.0;  ///< radians, in the plane of the camera and the line; if feature.has_depth
};

/// Straight lines of a frame: segments are detected, refined to sub-pixel accuracy, merged, lifted with the depth image
/// and described. Segments without usable depth stay, in the image only. Results depend on the arguments alone. One
/// object per thread.
class LineExtractor {
 public:
  /// `options` must be valid.
  explicit LineExtractor(const LineExtractorOptions& options = {});

  /// The lines, longest first. `grey` is CV_8UC1, `depth` is CV_32FC1 in metres, both undistorted and of the camera's
  /// size.
  [[nodiscard]] std::vector<MeasuredLine> extract(const cv::Mat& grey, const cv::Mat& depth,
                                                  const geometry::CameraModel& camera);

 private:
  [[nodiscard]] std::vector<Segment> find_segments(const cv::Mat& grey);

  LineExtractorOptions options_;
  LineDetector detector_;
  GradientImages gradients_;  ///< of the last frame; kept for its memory
};

/// The same for a single frame.
std::vector<MeasuredLine> extract_lines(const cv::Mat& grey, const cv::Mat& depth, const geometry::CameraModel& camera,
                                        const LineExtractorOptions& options = {});

}  // namespace eg::features
