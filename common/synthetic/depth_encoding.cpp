#include "common/synthetic/depth_encoding.hpp"

#include <cmath>
#include <cstdint>

#include "common/base/check.hpp"

namespace eg::synthetic {

cv::Mat encode_depth(const cv::Mat& depth_metres, double units_per_metre) {
  EG_CHECK(depth_metres.type() == CV_32FC1, "depth in metres is CV_32FC1");
  cv::Mat raw(depth_metres.size(), CV_16UC1);
  for (int y = 0; y < raw.rows; ++y) {
    const auto* metres = depth_metres.ptr<float>(y);
    auto* units = raw.ptr<std::uint16_t>(y);
    for (int x = 0; x < raw.cols; ++x) {
      const double value = std::floor(metres[x] * units_per_metre + 0.5);
      units[x] = value > 0.0 && value <= 65535.0 ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
    }
  }
  return raw;
}

cv::Mat decode_depth(const cv::Mat& depth, double units_per_metre) {
  EG_CHECK(depth.type() == CV_16UC1, "stored depth is CV_16UC1");
  cv::Mat metres;
  depth.convertTo(metres, CV_32FC1, 1.0 / units_per_metre);
  return metres;
}

}  // namespace eg::synthetic
