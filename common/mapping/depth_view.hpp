#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/image/rgbd_frame.hpp"
#include "common/mapping/mesh.hpp"
#include "common/mapping/tsdf_options.hpp"

namespace eg::mapping {

/// A frame prepared for being looked up at the projections of voxels.
class DepthView {
 public:
  DepthView(const image::RectifiedFrame& frame, const TsdfOptions& options);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// 1 / depth of a pixel, 1/m; 0 where there is no usable reading.
  [[nodiscard]] float inverse_depth(int x, int y) const { return inverse_depth_[index(x, y)]; }

  /// 1 / depth at a position between pixels; 0 where there is none. Bilinear in the inverse depth, which is exact on
  /// planes; beside a depth edge or a missing reading, where a mean would be no surface, the nearest pixel's.
  [[nodiscard]] float inverse_depth_at(float u, float v) const {
    // Written so that NaN fails too.
    if (!(u >= 0.0F && v >= 0.0F && u < static_cast<float>(width_ - 1) && v < static_cast<float>(height_ - 1)))
      return 0.0F;
    const int x = static_cast<int>(u);
    const int y = static_cast<int>(v);
    const float* top = &inverse_depth_[index(x, y)];
    const float* bottom = top + width_;
    const float du = u - static_cast<float>(x);
    const float dv = v - static_cast<float>(y);
    const float low = std::min(std::min(top[0], top[1]), std::min(bottom[0], bottom[1]));
    const float high = std::max(std::max(top[0], top[1]), std::max(bottom[0], bottom[1]));
    // 1 / low - 1 / high is the range of depths.
    if (high - low > continuity_ * high * low) return (dv < 0.5F ? top : bottom)[du < 0.5F ? 0 : 1];
    const float upper = top[0] + du * (top[1] - top[0]);
    const float lower = bottom[0] + du * (bottom[1] - bottom[0]);
    return upper + dv * (lower - upper);
  }

  /// Colour of the pixel nearest to a position inside the image.
  [[nodiscard]] Colour colour_at(float u, float v) const {
    const std::uint8_t* bgr =
        colour_.ptr<std::uint8_t>(static_cast<int>(v + 0.5F)) + 3 * static_cast<std::ptrdiff_t>(u + 0.5F);
    return {bgr[2], bgr[1], bgr[0]};
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_;
  int height_;
  float continuity_;  ///< metres: neighbouring readings that differ by more lie on different surfaces
  std::vector<float> inverse_depth_;
  cv::Mat colour_;
};

}  // namespace eg::mapping
