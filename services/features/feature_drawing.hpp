#pragma once

#include <opencv2/core/mat.hpp>

#include "common/features/features.hpp"

namespace eg::features_tool {

/// One frame's features over its colour image (CV_8UC3): planes tinted and outlined by their hulls, lines in the colour
/// of their vanishing direction (grey without depth or group, white for potential directions), arrows of the directions
/// at the edges of the image, and points as circles with their orientation, by octave, filled if they have depth.
/// `plane_labels` is CV_8UC1: 0 none, i + 1 belongs to planes[i].
cv::Mat draw_features(const cv::Mat& colour, const cv::Mat& plane_labels, const features::FrameFeatures& features);

}  // namespace eg::features_tool
