#include "common/mapping/depth_view.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <limits>

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
    : width_(frame.camera.width),
      height_(frame.camera.height),
      blocks_x_((width_ + kBlock - 1) / kBlock),
      blocks_y_((height_ + kBlock - 1) / kBlock),
      continuity_(static_cast<float>(2.0 * options.voxel_size)),
      steepest_(static_cast<float>(1.0 / (static_cast<double>(kMinObliqueness) * frame.camera.fx))),
      inverse_depth_(pixel(1, height_ + 1), 0.0F),
      obliqueness_(block(0, blocks_y_), kNone),
      signed_inverse_depth_(inverse_depth_.size(), 0.0F),
      pixel_obliqueness_(inverse_depth_.size(), 1.0F),
      ranges_(obliqueness_.size()),
      colour_(frame.colour.isContinuous() ? frame.colour : frame.colour.clone()) {
  invert_depth(frame.depth, options);
  compute_obliqueness(frame.camera, measure_blocks());
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
      if (inverse[column] == 0.0F) continue;
      sum += inverse[column];
      low = std::min(low, inverse[column]);
      high = std::max(high, inverse[column]);
      ++readings;
    }
  }
  const bool is_surface = readings >= kLeastReadings && !is_depth_edge(low, high, kBlock);
  return is_surface ? sum / static_cast<float>(readings) : kNone;
}

std::vector<float> DepthView::measure_blocks() const {
  std::vector<float> means(obliqueness_.size(), kNone);
  tbb::parallel_for(0, height_ / kBlock, [&](int y) {
    for (int x = 0; x < width_ / kBlock; ++x) means[block(x, y)] = mean_of_surface(x, y);
  });
  return means;
}

void DepthView::compute_obliqueness(const geometry::CameraModel& camera, const std::vector<float>& means) {
  // On the plane n·x = d, 1/z = (n/d)·ray is linear in the pixel; its coefficients give n/d, whose norm is 1/d. Beyond
  // the plane by dz along the axis, the distance from it is dz·d/z.
  const auto mean_at = [&](int x, int y) {
    return x < 0 || y < 0 || x >= blocks_x_ || y >= blocks_y_ ? kNone : means[block(x, y)];
  };
  const auto fx = static_cast<float>(camera.fx);
  const auto fy = static_cast<float>(camera.fy);
  constexpr auto kStep = static_cast<float>(kReach * kBlock);
  tbb::parallel_for(0, blocks_y_, [&](int y) {
    const float v = static_cast<float>(kBlock * y) + 0.5F * (kBlock - 1) - static_cast<float>(camera.cy);
    for (int x = 0; x < blocks_x_; ++x) {
      const float here = mean_at(x, y);
      if (std::isnan(here)) continue;
      const float slope_u = one_sided_slope(mean_at(x - kReach, y), here, mean_at(x + kReach, y)) / kStep;
      const float slope_v = one_sided_slope(mean_at(x, y - kReach), here, mean_at(x, y + kReach)) / kStep;
      const float u = static_cast<float>(kBlock * x) + 0.5F * (kBlock - 1) - static_cast<float>(camera.cx);
      const Eigen::Vector3f normal_over_distance(fx * slope_u, fy * slope_v, here - slope_u * u - slope_v * v);
      obliqueness_[block(x, y)] =
          std::clamp(here / normal_over_distance.norm(), kMinObliqueness, kMaxObliqueness);  // NaN stays
    }
  });
  fill_gaps_in_obliqueness(means);
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
  tbb::parallel_for(0, height_, [&](int y) {
    const std::size_t row = pixel(0, y);
    const auto width = static_cast<std::size_t>(width_);
    for (std::size_t i = row; i < row + width; ++i) {
      const float signed_obliqueness = obliqueness_[block(static_cast<int>(i - row) / kBlock, y / kBlock)];
      const auto [low, high] = std::minmax(
          {inverse_depth_[i], inverse_depth_[i + 1], inverse_depth_[i + width], inverse_depth_[i + width + 1]});
      const bool at_edge = is_depth_edge(low, high, 1.0F / std::abs(signed_obliqueness));
      signed_inverse_depth_[i] = at_edge ? -inverse_depth_[i] : inverse_depth_[i];
      pixel_obliqueness_[i] = signed_obliqueness;
    }
  });
}

void DepthView::bound_blocks() {
  tbb::parallel_for(0, blocks_y_, [&](int block_y) {
    for (int y = kBlock * block_y; y < std::min(kBlock * (block_y + 1), height_); ++y) {
      for (int x = 0; x < width_; ++x) {
        DepthRange& range = ranges_[block(x / kBlock, block_y)];
        const std::size_t at = pixel(x, y);
        const float inverse = inverse_depth_[at];
        range.obliqueness = std::min(range.obliqueness, std::abs(pixel_obliqueness_[at]));
        if (inverse > 0.0F) range.low = std::min(range.low, inverse);
        range.high = std::max(range.high, inverse);
        if (!(signed_inverse_depth_[at] > 0.0F) || std::signbit(pixel_obliqueness_[at])) range.is_plain = false;
      }
    }
  });
}

DepthRange DepthView::range(int first_x, int first_y, int last_x, int last_y) const {
  DepthRange joined;
  for (int y = first_y / kBlock; y <= last_y / kBlock; ++y) {
    for (int x = first_x / kBlock; x <= last_x / kBlock; ++x) joined.join(ranges_[block(x, y)]);
  }
  return joined;
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
