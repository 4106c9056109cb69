#pragma once

#include <opencv2/core/mat.hpp>

#include "common/base/result.hpp"
#include "common/features/direction_extractor.hpp"
#include "common/features/features.hpp"
#include "common/features/line_extractor.hpp"
#include "common/features/plane_extraction.hpp"
#include "common/features/point_extractor.hpp"
#include "common/image/rgbd_frame.hpp"

namespace eg::features {

struct FeatureExtractorOptions {
  PointExtractorOptions points;
  LineExtractorOptions lines;
  DirectionExtractorOptions directions;
  PlaneOptions planes;
};

/// Names the first option that is out of range.
base::Status validate(const FeatureExtractorOptions& options);

/// All features of a frame (paper, section 4.1). Points, lines and planes are found side by side on the threads that
/// oneTBB has; the result does not depend on how many there are. One object per thread.
class FeatureExtractor {
 public:
  /// `options` must be valid.
  explicit FeatureExtractor(const FeatureExtractorOptions& options = {});

  /// Directions are ordered by kind: plane normals (as many as planes, in their order), vanishing directions, potential
  /// directions.
  [[nodiscard]] FrameFeatures extract(const image::RectifiedFrame& frame);

  /// CV_8UC1, of the last frame: 0 none, i + 1 belongs to planes[i].
  [[nodiscard]] const cv::Mat& plane_labels() const { return plane_labels_; }

 private:
  FeatureExtractorOptions options_;
  LineExtractor line_extractor_;
  PlaneExtractor plane_extractor_;
  cv::Mat grey_;  ///< of the last frame; kept for its memory
  cv::Mat plane_labels_;
};

}  // namespace eg::features
