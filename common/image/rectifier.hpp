#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "common/image/rgbd_frame.hpp"

namespace eg::image {

/// Removes lens distortion from frames and turns raw depth into metres. Keeps the look-up maps of the last camera seen.
/// Colour is interpolated; depth takes the nearest reading, because a mean across a depth edge is no surface.
/// Straightening bends the borders of the image inwards. What the lens did not see is cut off, so the rectified image
/// may be smaller than the camera's (tum_fr1: 605 x 456): a seam beside black pixels would pass for lines and corners
/// that move with the camera.
class Rectifier {
 public:
  /// The result's camera has the rectified image's size and principal point.
  [[nodiscard]] RectifiedFrame rectify(const RgbdFrame& frame);

 private:
  void make_maps(const geometry::CameraModel& camera);

  geometry::CameraModel camera_;
  geometry::CameraModel rectified_camera_;
  cv::Mat map_x_, map_y_;  ///< where the lens put every pixel of the rectified image
};

}  // namespace eg::image
