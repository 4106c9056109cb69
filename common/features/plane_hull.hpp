#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/features/features.hpp"
#include "common/features/plane_blocks.hpp"

namespace eg::features {

/// Convex hull on each plane of the pixels labelled i + 1 (labels: CV_8UC1) in plane i's coordinates, at most
/// kMaxHullPoints points, camera frame, metres.
void add_hulls(const cv::Mat& labels, const BlockGrid& grid, std::vector<PlaneFeature>& planes);

}  // namespace eg::features
