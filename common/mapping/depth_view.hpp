#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/image/rgbd_frame.hpp"
#include "common/mapping/tsdf_options.hpp"
#include "common/mapping/vector4.hpp"

namespace eg::mapping {

/// What some pixels show, within bounds.
struct DepthRange {
  float low = std::numeric_limits<float>::infinity();  ///< smallest inverse depth of a reading, 1/m
  float high = 0.0F;                                   ///< largest; 0: there is no reading
  float obliqueness = 2.0F;                            ///< the least, DepthView::obliqueness()
  bool is_plain = true;                                ///< every pixel has a reading, and no depth edge is near

  void join(const DepthRange& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
    obliqueness = std::min(obliqueness, other.obliqueness);
    is_plain = is_plain && other.is_plain;
  }
};

/// Pixels from (left, top) to (right, bottom), these included.
struct PixelRect {
  int left, top, right, bottom;
};

/// By how much readings may differ from a plane: inverse depth minus the plane's, 1/m. Of no readings none is between.
struct Residuals {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();
};

/// A frame prepared for being looked up at the projections of voxels: inverse depth by pixels, slope and edges by
/// blocks of pixels. Plain arrays, so that loops over voxels can be vectorised.
class DepthView {
 public:
  static constexpr int kBlock = 4;  ///< side of a block, pixels

  DepthView(const image::RectifiedFrame& frame, const TsdfOptions& options);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int blocks_x() const { return blocks_x_; }
  [[nodiscard]] int blocks_y() const { return blocks_y_; }

  /// 1 / depth of a pixel, 1/m; 0 where there is no usable reading.
  [[nodiscard]] float inverse_depth(int x, int y) const { return inverse_depth_[pixel(x, y)]; }

  /// Distance from the surface per difference of depth: the cosine of the angle between its normal and the optical
  /// axis, over that of the pixel's ray. By blocks.
  [[nodiscard]] float obliqueness(int block_x, int block_y) const {
    return std::abs(obliqueness_[block(block_x, block_y)]);
  }
  /// Whether a block shows more than one surface, or hardly any of its pixels show one.
  [[nodiscard]] bool at_edge(int block_x, int block_y) const {
    return std::signbit(obliqueness_[block(block_x, block_y)]);
  }

  [[nodiscard]] const DepthRange& range(int block_x, int block_y) const { return ranges_[block(block_x, block_y)]; }

  /// Bounds for the blocks that a rectangle of pixels inside the image lies in. What a pixel is interpolated from is
  /// within the bounds of the rectangle that is one pixel larger to the right and below.
  [[nodiscard]] DepthRange range(const PixelRect& pixels) const;

  /// The plane of the surface in the middle of a rectangle inside the image: its normal over its distance from the
  /// camera, in the camera frame, so that the scalar product with a point of the plane is 1 and with (x / z, y / z, 1)
  /// the inverse depth. One across the optical axis where no surface is known.
  [[nodiscard]] Eigen::Vector3f plane_amid(const PixelRect& pixels) const;

  /// How the blocks of a rectangle inside the image, and what is interpolated within it or stands for half a pixel
  /// around, differ from a plane.
  [[nodiscard]] Residuals residuals(const PixelRect& pixels, const Eigen::Vector3f& plane) const;

  // The same for lookups by voxels: row by row, with one row and a pixel more than the image has, so that the
  // neighbours below and to the right of every pixel can be read.

  /// From a pixel to the one below.
  [[nodiscard]] int stride() const { return stride_; }
  /// Inverse depths; with a minus sign where a pixel and those neighbours do not show one surface.
  [[nodiscard]] const float* signed_inverse_depth() const { return signed_inverse_depth_.data(); }
  /// Obliqueness of the pixels' blocks; with a minus sign at_edge().
  [[nodiscard]] const float* signed_obliqueness() const { return pixel_obliqueness_.data(); }

  /// Red, green, blue and a byte that means nothing, row by row without gaps.
  [[nodiscard]] const std::uint8_t* colour() const { return colour_.ptr<std::uint8_t>(); }

 private:
  [[nodiscard]] std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride_) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] std::size_t block(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(blocks_x_) + static_cast<std::size_t>(x);
  }

  /// Mask: inverse depths belong to two surfaces. `scale`: how many pixels they are apart, over the obliqueness.
  [[nodiscard]] Int4 is_depth_edge(Float4 low, Float4 high, float scale) const {
    return high - low > scale * low * max(continuity_ * high, all(steepest_));
  }

  void invert_depth(const cv::Mat& depth, const TsdfOptions& options);
  /// Mean inverse depth of a block that lies on one surface, else NaN.
  [[nodiscard]] float mean_of_surface(int block_x, int block_y) const;
  [[nodiscard]] std::vector<float> measure_blocks() const;
  void fit_planes(const std::vector<float>& means);
  void fill_gaps_in_obliqueness(const std::vector<float>& means);
  void sign_pixels();
  void bound_blocks();
  [[nodiscard]] DepthRange bound_block(int block_x, int block_y) const;
  /// Of the blocks around one that are known; 1 if none is.
  [[nodiscard]] float mean_around(const std::vector<float>& obliqueness, int x, int y) const;

  float fx_, fy_, cx_, cy_;
  int width_;
  int height_;
  int blocks_x_;
  int blocks_y_;
  int stride_;        ///< whole blocks
  float continuity_;  ///< step between neighbours that always passes, metres
  float steepest_;    ///< what the steepest surface that is looked at has from pixel to pixel, as a share of the depth
  std::vector<float> inverse_depth_;
  std::vector<float> obliqueness_;       ///< by blocks
  std::vector<Eigen::Vector3f> planes_;  ///< by blocks
  std::vector<float> signed_inverse_depth_;
  std::vector<float> pixel_obliqueness_;
  std::vector<DepthRange> ranges_;  ///< by blocks
  cv::Mat colour_;
};

}  // namespace eg::mapping
