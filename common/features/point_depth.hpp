#pragma once

#include <opencv2/core/mat.hpp>

namespace eg::features {

/// A depth image value with its uncertainty. `depth` is 0 where there is none to be trusted.
struct DepthReading {
  double depth = 0.0;  ///< z, metres
  double sigma = 0.0;  ///< metres

  [[nodiscard]] bool valid() const { return depth > 0.0; }
};

/// The difference in depth (metres) between neighbouring pixels at depth `z` from which on they are taken to lie on
/// different surfaces: beyond what noise and slanted surfaces explain.
inline double depth_jump(double z) { return 0.04 * z + 0.02; }

/// Depth at a pixel of a metric depth image (CV_32FC1). The 3x3 neighbourhood decides: if it holds one surface, the
/// reading is that of the pixel itself (or the mean of its neighbours, if the pixel has none). At a depth edge the
/// nearer surface counts, because a corner or edge at an occlusion boundary belongs to what occludes; it must fill at
/// least three pixels. Outside the image and where fewer than three pixels have a reading, there is none.
DepthReading read_depth(const cv::Mat& depth, int x, int y);

}  // namespace eg::features
