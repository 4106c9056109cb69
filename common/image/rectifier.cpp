#include "common/image/rectifier.hpp"

#include <algorithm>
#include <array>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace eg::image {
namespace {

/// Share of the pixels of `part` that no pixel of the distorted image belongs to.
double unseen_share(const cv::Mat& seen, const cv::Rect& part) {
  return 1.0 - static_cast<double>(cv::countNonZero(seen(part))) / part.area();
}

/// The part of the image that was seen as a whole: takes the side away that has the most unseen pixels until none has
/// any. All of the image if less than half its width or height would be left: such a lens is a mistake.
cv::Rect seen_part(const cv::Mat& seen) {
  const cv::Rect all(0, 0, seen.cols, seen.rows);
  cv::Rect part = all;
  while (2 * part.width >= all.width && 2 * part.height >= all.height) {
    const std::array<double, 4> unseen = {unseen_share(seen, {part.x, part.y, 1, part.height}),
                                          unseen_share(seen, {part.x + part.width - 1, part.y, 1, part.height}),
                                          unseen_share(seen, {part.x, part.y, part.width, 1}),
                                          unseen_share(seen, {part.x, part.y + part.height - 1, part.width, 1})};
    const auto worst = std::max_element(unseen.begin(), unseen.end()) - unseen.begin();
    if (unseen[static_cast<std::size_t>(worst)] == 0.0) return part;
    if (worst == 0) ++part.x;
    if (worst == 2) ++part.y;
    (worst < 2 ? part.width : part.height) -= 1;
  }
  return all;
}

}  // namespace

void Rectifier::make_maps(const geometry::CameraModel& camera) {
  const cv::Matx33d k(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const auto& [k1, k2, p1, p2, k3] = camera.distortion;
  const cv::Matx<double, 1, 5> distortion(k1, k2, p1, p2, k3);
  cv::Mat x, y;
  cv::initUndistortRectifyMap(k, distortion, cv::Matx33d::eye(), k, {camera.width, camera.height}, CV_32FC1, x, y);
  const cv::Mat seen = (x >= 0) & (x <= camera.width - 1) & (y >= 0) & (y <= camera.height - 1);
  const cv::Rect part = seen_part(seen);
  map_x_ = x(part).clone();
  map_y_ = y(part).clone();

  camera_ = camera;
  rectified_camera_ = camera;
  rectified_camera_.distortion = {};
  rectified_camera_.width = part.width;
  rectified_camera_.height = part.height;
  rectified_camera_.cx -= part.x;
  rectified_camera_.cy -= part.y;
}

RectifiedFrame Rectifier::rectify(const RgbdFrame& frame) {
  RectifiedFrame rectified{frame.header, frame.camera, frame.colour, {}};
  cv::Mat depth;
  frame.depth.convertTo(depth, CV_32FC1, 1.0 / frame.camera.depth_units_per_metre);
  if (!frame.camera.has_distortion()) {
    rectified.depth = depth;
    return rectified;
  }
  if (frame.camera != camera_) make_maps(frame.camera);
  rectified.camera = rectified_camera_;
  rectified.colour = cv::Mat();
  cv::remap(frame.colour, rectified.colour, map_x_, map_y_, cv::INTER_LINEAR);
  cv::remap(depth, rectified.depth, map_x_, map_y_, cv::INTER_NEAREST);
  return rectified;
}

}  // namespace eg::image
