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

  /// What is seen at a position between pixels.
  struct Sample {
    float inverse_depth = 0.0F;  ///< 1/m; 0 where there is nothing
    /// Distance from the surface per difference of depth: the cosine of the angle between its normal and the optical
    /// axis, over that of the pixel's ray. Known by blocks of pixels.
    float obliqueness = 1.0F;
    bool at_edge = false;  ///< in a block of pixels that show more than one surface, or not all of them any
  };

  /// Bilinear in the inverse depth, which is exact on planes; beside a depth edge or a missing reading, where a mean
  /// would be no surface, the nearest pixel's.
  [[nodiscard]] Sample sample(float u, float v) const {
    const auto right = static_cast<float>(width_ - 1);
    const auto bottom = static_cast<float>(height_ - 1);
    if (!(u >= 0.0F && v >= 0.0F && u < right && v < bottom)) return {};  // so written that NaN is outside
    const int x = static_cast<int>(u);
    const int y = static_cast<int>(v);
    const float* above = &inverse_depth_[index(x, y)];
    const float* below = above + width_;
    const float du = u - static_cast<float>(x);
    const float dv = v - static_cast<float>(y);
    const float low = std::min(std::min(above[0], above[1]), std::min(below[0], below[1]));
    const float high = std::max(std::max(above[0], above[1]), std::max(below[0], below[1]));
    const std::size_t b = block(x / kBlock, y / kBlock);
    const float obliqueness = obliqueness_[b];
    const bool at_edge = at_edge_[b] != 0;
    if (is_depth_edge(low, high, 1.0F / obliqueness)) {
      return {(dv < 0.5F ? above : below)[du < 0.5F ? 0 : 1], obliqueness, at_edge};
    }
    const float upper = above[0] + du * (above[1] - above[0]);
    const float lower = below[0] + du * (below[1] - below[0]);
    return {upper + dv * (lower - upper), obliqueness, at_edge};
  }

  /// Sample::obliqueness at a pixel.
  [[nodiscard]] float obliqueness(int x, int y) const { return obliqueness_[block(x / kBlock, y / kBlock)]; }

  /// Colour of the pixel nearest to a position inside the image.
  [[nodiscard]] Colour colour_at(float u, float v) const {
    const std::uint8_t* bgr =
        colour_.ptr<std::uint8_t>(static_cast<int>(v + 0.5F)) + 3 * static_cast<std::ptrdiff_t>(u + 0.5F);
    return {bgr[2], bgr[1], bgr[0]};
  }

 private:
  static constexpr int kBlock = 4;  ///< side of the blocks of obliqueness, pixels

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  /// Whether depths from 1 / high to 1 / low are `scale` times too far apart for neighbours on one surface. Always if
  /// `low` is 0: no reading.
  [[nodiscard]] bool is_depth_edge(float low, float high, float scale) const {
    return high - low > scale * low * std::max(continuity_ * high, steepest_);
  }

  [[nodiscard]] std::size_t block(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(blocks_x_) + static_cast<std::size_t>(x);
  }

  /// Mean inverse depth of each block that lies on one surface, else NaN. Sets at_edge_.
  std::vector<float> measure_blocks();
  void compute_obliqueness(const geometry::CameraModel& camera);
  void fill_gaps_in_obliqueness();

  int width_;
  int height_;
  int blocks_x_;
  int blocks_y_;
  float continuity_;  ///< metres; neighbouring readings that differ by less are always taken for one surface's
  float steepest_;    ///< the same as a share of the depth: what the steepest surface that is looked at has
  std::vector<float> inverse_depth_;
  std::vector<float> obliqueness_;
  std::vector<std::uint8_t> at_edge_;  ///< by blocks
  cv::Mat colour_;
};

}  // namespace eg::mapping
