#include "common/image/rectifier.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace eg::image {

RectifiedFrame Rectifier::rectify(const RgbdFrame& frame) {
  RectifiedFrame rectified{frame.header, frame.camera, frame.colour, {}};
  frame.depth.convertTo(rectified.depth, CV_32FC1, 1.0 / frame.camera.depth_units_per_metre);
  if (!frame.camera.has_distortion()) return rectified;

  if (frame.camera != camera_) {
    camera_ = frame.camera;
    const cv::Matx33d k(camera_.fx, 0, camera_.cx, 0, camera_.fy, camera_.cy, 0, 0, 1);
    const cv::Mat distortion(1, 5, CV_64F, camera_.distortion.data());
    cv::initUndistortRectifyMap(k, distortion, cv::Matx33d::eye(), k, {camera_.width, camera_.height}, CV_32FC1, map_x_,
                                map_y_);
  }
  cv::Mat depth;
  cv::remap(frame.colour, rectified.colour, map_x_, map_y_, cv::INTER_LINEAR);
  cv::remap(rectified.depth, depth, map_x_, map_y_, cv::INTER_NEAREST);
  rectified.depth = depth;
  rectified.camera.distortion = {};
  return rectified;
}

}  // namespace eg::image
