#include "common/mapping/depth_view.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <limits>
#include <opencv2/imgproc.hpp>

namespace eg::mapping {
namespace {

// Below this, at 81 degrees, slopes are too uncertain; above the other, no pixel of a usual lens can be.
constexpr float kMinObliqueness = 0.15F;
constexpr float kMaxObliqueness = 2.0F;
// Slopes are taken between blocks this far apart: noise counts less, and at 8 pixels objects are still resolved.
constexpr int kReach = 2;
// Of the 16 in a block: surfaces seen at a grazing angle lose many.
constexpr int kLeastReadings = 4;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Derivative from the values at -1, 0 and 1: the flatter of the two sides, because beside an edge the other one leaves
/// the surface. NaN if there is none.
float one_sided_slope(float before, float here, float after) {
  const float backward = here - before;
  const float forward = after - here;
  if (std::isnan(backward)) return forward;
  return std::abs(forward) < std::abs(backward) ? forward : backward;  // also if forward is NaN
}

}  // namespace

DepthView::DepthView(const image::RectifiedFrame& frame, const TsdfOptions& options)
    : fx_(static_cast<float>(frame.camera.fx)),
      fy_(static_cast<float>(frame.camera.fy)),
      cx_(static_cast<float>(frame.camera.cx)),
      cy_(static_cast<float>(frame.camera.cy)),
      width_(frame.camera.width),
      height_(frame.camera.height),
      blocks_x_((width_ + kBlock - 1) / kBlock),
      blocks_y_((height_ + kBlock - 1) / kBlock),
      stride_(kBlock * blocks_x_),
      continuity_(static_cast<float>(2.0 * options.voxel_size)),
      steepest_(static_cast<float>(1.0 / (static_cast<double>(kMinObliqueness) * frame.camera.fx))),
      inverse_depth_(pixel(1, height_ + 1), 0.0F),
      obliqueness_(block(0, blocks_y_), kNone),
      planes_(obliqueness_.size(), Eigen::Vector3f::Constant(kNone)),
      signed_inverse_depth_(inverse_depth_.size(), 0.0F),
      pixel_obliqueness_(inverse_depth_.size(), 1.0F),
      ranges_(obliqueness_.size()) {
  cv::cvtColor(frame.colour, colour_, cv::COLOR_BGR2RGBA);
  invert_depth(frame.depth, options);
  const std::vector<float> means = measure_blocks();
  fit_planes(means);
  fill_gaps_in_obliqueness(means);
  sign_pixels();
  bound_blocks();
}

void DepthView::invert_depth(const cv::Mat& depth, const TsdfOptions& options) {
  const auto nearest = static_cast<float>(options.min_depth);
  const auto farthest = static_cast<float>(options.max_depth);
  tbb::parallel_for(0, height_, [&](int y) {
    const auto* row = depth.ptr<float>(y);
    float* inverse = &inverse_depth_[pixel(0, y)];
    for (int x = 0; x < width_; ++x) {
      const bool usable = row[x] >= nearest && row[x] <= farthest;  // false for NaN
      inverse[x] = usable ? 1.0F / row[x] : 0.0F;
    }
  });
}

float DepthView::mean_of_surface(int block_x, int block_y) const {
  float sum = 0.0F;
  float low = std::numeric_limits<float>::max();
  float high = 0.0F;
  int readings = 0;
  for (int row = 0; row < kBlock; ++row) {
    const float* inverse = &inverse_depth_[pixel(block_x * kBlock, block_y * kBlock + row)];
    for (int column = 0; column < kBlock; ++column) {
      const bool is_reading = inverse[column] > 0.0F;
      sum += inverse[column];
      low = is_reading ? std::min(low, inverse[column]) : low;
      high = std::max(high, inverse[column]);
      readings += static_cast<int>(is_reading);
    }
  }
  const bool is_surface = readings >= kLeastReadings && is_depth_edge(all(low), all(high), kBlock)[0] == 0;
  return is_surface ? sum / static_cast<float>(readings) : kNone;
}

std::vector<float> DepthView::measure_blocks() const {
  std::vector<float> means(obliqueness_.size(), kNone);
  tbb::parallel_for(0, height_ / kBlock, [&](int y) {
    for (int x = 0; x < width_ / kBlock; ++x) means[block(x, y)] = mean_of_surface(x, y);
  });
  return means;
}

void DepthView::fit_planes(const std::vector<float>& means) {
  // On the plane n·x = d, 1/z = (n/d)·ray is linear in the pixel; its coefficients give n/d, whose norm is 1/d. Beyond
  // the plane by dz along the axis, the distance from it is dz·d/z.
  const auto mean_at = [&](int x, int y) {
    return x < 0 || y < 0 || x >= blocks_x_ || y >= blocks_y_ ? kNone : means[block(x, y)];
  };
  constexpr auto kStep = static_cast<float>(kReach * kBlock);
  tbb::parallel_for(0, blocks_y_, [&](int y) {
    const float v = static_cast<float>(kBlock * y) + 0.5F * (kBlock - 1) - cy_;
    for (int x = 0; x < blocks_x_; ++x) {
      const float here = mean_at(x, y);
      if (std::isnan(here)) continue;
      const float slope_u = one_sided_slope(mean_at(x - kReach, y), here, mean_at(x + kReach, y)) / kStep;
      const float slope_v = one_sided_slope(mean_at(x, y - kReach), here, mean_at(x, y + kReach)) / kStep;
      const float u = static_cast<float>(kBlock * x) + 0.5F * (kBlock - 1) - cx_;
      const Eigen::Vector3f normal_over_distance(fx_ * slope_u, fy_ * slope_v, here - slope_u * u - slope_v * v);
      const float obliqueness = here / normal_over_distance.norm();
      obliqueness_[block(x, y)] = std::clamp(obliqueness, kMinObliqueness, kMaxObliqueness);  // NaN stays
      if (obliqueness >= kMinObliqueness) planes_[block(x, y)] = normal_over_distance;
    }
  });
}

void DepthView::fill_gaps_in_obliqueness(const std::vector<float>& means) {
  const std::vector<float> known = obliqueness_;
  tbb::parallel_for(0, blocks_y_, [&](int y) {
    for (int x = 0; x < blocks_x_; ++x) {
      float& obliqueness = obliqueness_[block(x, y)];
      if (std::isnan(obliqueness)) obliqueness = mean_around(known, x, y);
      if (std::isnan(means[block(x, y)])) obliqueness = -obliqueness;
    }
  });
}

void DepthView::sign_pixels() {
  static_assert(kBlock == 4, "a row of a block is a vector");
  tbb::parallel_for(0, height_, [&](int y) {
    for (int block_x = 0; block_x < blocks_x_; ++block_x) {
      const float signed_obliqueness = obliqueness_[block(block_x, y / kBlock)];
      const std::size_t at = pixel(kBlock * block_x, y);
      const float* const here = &inverse_depth_[at];
      const Float4 inverse = load(here);
      const Float4 right = load(here + 1);
      const Float4 below = load(here + stride_);
      const Float4 diagonal = load(here + stride_ + 1);
      const Int4 at_edge =
          is_depth_edge(min(min(inverse, right), min(below, diagonal)), max(max(inverse, right), max(below, diagonal)),
                        1.0F / std::abs(signed_obliqueness));
      store(at_edge ? -inverse : inverse, &signed_inverse_depth_[at]);
      store(all(signed_obliqueness), &pixel_obliqueness_[at]);
    }
  });
}

void DepthView::bound_blocks() {
  tbb::parallel_for(0, blocks_y_, [&](int block_y) {
    for (int block_x = 0; block_x < blocks_x_; ++block_x)
      ranges_[block(block_x, block_y)] = bound_block(block_x, block_y);
  });
}

DepthRange DepthView::bound_block(int block_x, int block_y) const {
  constexpr Float4 kZero = {0.0F, 0.0F, 0.0F, 0.0F};
  DepthRange range;
  Float4 low = all(range.low);
  Float4 high = all(range.high);
  Int4 is_plain = kZero == kZero;
  for (int y = kBlock * block_y; y < std::min(kBlock * (block_y + 1), height_); ++y) {
    const std::size_t at = pixel(kBlock * block_x, y);
    const Float4 inverse = load(&inverse_depth_[at]);
    low = min(low, inverse > kZero ? inverse : low);
    high = max(high, inverse);
    is_plain &= load(&signed_inverse_depth_[at]) > kZero;
  }
  range.low = least(low);
  range.high = greatest(high);
  range.obliqueness = obliqueness(block_x, block_y);
  range.is_plain = !any(~is_plain) && !at_edge(block_x, block_y);
  return range;
}

DepthRange DepthView::range(const PixelRect& pixels) const {
  DepthRange joined;
  for (int y = pixels.top / kBlock; y <= pixels.bottom / kBlock; ++y) {
    for (int x = pixels.left / kBlock; x <= pixels.right / kBlock; ++x) joined.join(ranges_[block(x, y)]);
  }
  return joined;
}

Eigen::Vector3f DepthView::plane_amid(const PixelRect& pixels) const {
  const std::size_t amid =
      block((pixels.left + pixels.right) / (2 * kBlock), (pixels.top + pixels.bottom) / (2 * kBlock));
  const Eigen::Vector3f& plane = planes_[amid];
  return plane.hasNaN() ? Eigen::Vector3f(0.0F, 0.0F, ranges_[amid].high) : plane;
}

Residuals DepthView::residuals(const PixelRect& pixels, const Eigen::Vector3f& plane) const {
  const float slope_u = plane.x() / fx_;
  const float slope_v = plane.y() / fy_;
  const int first_x = pixels.left / kBlock * kBlock;
  const Float4 first_u = static_cast<float>(first_x) - cx_ + Float4{0.0F, 1.0F, 2.0F, 3.0F};
  Float4 low = all(std::numeric_limits<float>::infinity());
  Float4 high = -low;
  for (int y = pixels.top; y <= pixels.bottom; ++y) {
    Float4 expected = plane.z() + slope_v * (static_cast<float>(y) - cy_) + slope_u * first_u;
    for (int x = first_x; x <= pixels.right; x += kBlock) {
      const Float4 inverse = load(&inverse_depth_[pixel(x, y)]);
      const Float4 residual = inverse - expected;
      const Int4 is_reading = inverse > 0.0F;
      low = min(low, is_reading ? residual : low);
      high = max(high, is_reading ? residual : high);
      expected += static_cast<float>(kBlock) * slope_u;
    }
  }
  const float half_a_pixel = 0.5F * (std::abs(slope_u) + std::abs(slope_v));
  return {least(low) - half_a_pixel, greatest(high) + half_a_pixel};
}

float DepthView::mean_around(const std::vector<float>& obliqueness, int x, int y) const {
  float sum = 0.0F;
  int count = 0;
  for (int row = std::max(0, y - 1); row < std::min(blocks_y_, y + 2); ++row) {
    for (int column = std::max(0, x - 1); column < std::min(blocks_x_, x + 2); ++column) {
      const float value = obliqueness[block(column, row)];
      if (std::isnan(value)) continue;
      sum += value;
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<float>(count) : 1.0F;
}

}  // namespace eg::mapping
