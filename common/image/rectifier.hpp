#pragma once

#include <opencv2/core/mat.hpp>

#include "common/image/rgbd_frame.hpp"

namespace eg::image {

/// Removes lens distortion from frames and turns raw depth into metres. Keeps the look-up maps of the last camera seen.
/// Colour is interpolated; depth takes the nearest reading, because a mean across a depth edge is no surface.
class Rectifier {
 public:
  [[nodiscard]] RectifiedFrame rectify(const RgbdFrame& frame);

 private:
  geometry::CameraModel camera_;
  cv::Mat map_x_, map_y_;
};

}  // namespace eg::image
