#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "common/geometry/camera_model.hpp"

namespace eg::image {

/// Who and when: carried along by everything that is derived from a frame.
struct FrameHeader {
  std::int64_t session = 0;   ///< which recording or robot; chosen by the frame source
  std::int64_t sequence = 0;  ///< counted from 0 without gaps by the frame source: a gap is a lost message
  std::int64_t utime = 0;     ///< acquisition time, microseconds
};

/// One colour and depth image pair as the sensor gave it.
struct RgbdFrame {
  FrameHeader header;
  geometry::CameraModel camera;
  cv::Mat colour;  ///< CV_8UC3, BGR, camera.height x camera.width
  cv::Mat depth;   ///< CV_16UC1, camera.depth_units_per_metre, 0 where there is no reading; registered to colour
};

/// An undistorted pair in metric units: what the algorithms work on.
struct RectifiedFrame {
  FrameHeader header;
  geometry::CameraModel camera;  ///< without distortion
  cv::Mat colour;                ///< CV_8UC3, BGR
  cv::Mat depth;                 ///< CV_32FC1, metres along the optical axis, 0 where there is no reading
};

}  // namespace eg::image
