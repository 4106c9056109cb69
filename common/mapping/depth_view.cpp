#include "common/mapping/depth_view.hpp"

#include <cmath>
#include <limits>

namespace eg::mapping {
namespace {

// Below this, at 81 degrees, slopes are too uncertain; above the other, no pixel of a usual lens can be.
constexpr double kMinObliqueness = 0.15;
constexpr double kMaxObliqueness = 2.0;
// Slopes are taken between blocks this far apart: noise counts less, and at 8 pixels objects are still resolved.
constexpr int kReach = 2;
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
      steepest_(static_cast<float>(1.0 / (kMinObliqueness * frame.camera.fx))),
      inverse_depth_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)),
      obliqueness_(static_cast<std::size_t>(blocks_x_) * static_cast<std::size_t>(blocks_y_), kNone),
      at_edge_(obliqueness_.size(), 1),
      colour_(frame.colour) {
  const auto nearest = static_cast<float>(options.min_depth);
  const auto farthest = static_cast<float>(options.max_depth);
  for (int y = 0; y < height_; ++y) {
    const auto* depth = frame.depth.ptr<float>(y);
    float* inverse = &inverse_depth_[index(0, y)];
    for (int x = 0; x < width_; ++x) {
      const bool usable = depth[x] >= nearest && depth[x] <= farthest;  // false for NaN
      inverse[x] = usable ? 1.0F / depth[x] : 0.0F;
    }
  }
  compute_obliqueness(frame.camera);
}

std::vector<float> DepthView::measure_blocks() {
  std::vector<float> means(obliqueness_.size(), kNone);
  for (int y = 0; y < height_ / kBlock; ++y) {
    for (int x = 0; x < width_ / kBlock; ++x) {
      float sum = 0.0F;
      float low = std::numeric_limits<float>::max();
      float high = 0.0F;
      for (int row = 0; row < kBlock; ++row) {
        const float* inverse = &inverse_depth_[index(x * kBlock, y * kBlock + row)];
        for (int column = 0; column < kBlock; ++column) {
          sum += inverse[column];
          low = std::min(low, inverse[column]);
          high = std::max(high, inverse[column]);
        }
      }
      if (low == 0.0F || is_depth_edge(low, high, kBlock)) continue;
      means[block(x, y)] = sum / (kBlock * kBlock);
      at_edge_[block(x, y)] = 0;
    }
  }
  return means;
}

void DepthView::compute_obliqueness(const geometry::CameraModel& camera) {
  // On the plane n·x = d, 1/z = (n/d)·ray is linear in the pixel; its coefficients give n/d, whose norm is 1/d. Beyond
  // the plane by dz along the axis, the distance from it is dz·d/z.
  const std::vector<float> means = measure_blocks();
  const auto mean_at = [&](int x, int y) {
    return x < 0 || y < 0 || x >= blocks_x_ || y >= blocks_y_ ? kNone : means[block(x, y)];
  };
  for (int y = 0; y < blocks_y_; ++y) {
    for (int x = 0; x < blocks_x_; ++x) {
      const float here = mean_at(x, y);
      const double slope_u = one_sided_slope(mean_at(x - kReach, y), here, mean_at(x + kReach, y)) / (kReach * kBlock);
      const double slope_v = one_sided_slope(mean_at(x, y - kReach), here, mean_at(x, y + kReach)) / (kReach * kBlock);
      const double u = kBlock * x + 0.5 * (kBlock - 1) - camera.cx;
      const double v = kBlock * y + 0.5 * (kBlock - 1) - camera.cy;
      const Eigen::Vector3d normal_over_distance(camera.fx * slope_u, camera.fy * slope_v,
                                                 here - slope_u * u - slope_v * v);
      obliqueness_[block(x, y)] =
          static_cast<float>(std::clamp(here / normal_over_distance.norm(), kMinObliqueness, kMaxObliqueness));
    }
  }
  fill_gaps_in_obliqueness();
}

void DepthView::fill_gaps_in_obliqueness() {
  const std::vector<float> known = obliqueness_;
  for (int y = 0; y < blocks_y_; ++y) {
    for (int x = 0; x < blocks_x_; ++x) {
      if (!std::isnan(known[block(x, y)])) continue;
      float sum = 0.0F;
      int count = 0;
      for (int row = std::max(0, y - 1); row < std::min(blocks_y_, y + 2); ++row) {
        for (int column = std::max(0, x - 1); column < std::min(blocks_x_, x + 2); ++column) {
          const float value = known[block(column, row)];
          if (std::isnan(value)) continue;
          sum += value;
          ++count;
        }
      }
      obliqueness_[block(x, y)] = count > 0 ? sum / static_cast<float>(count) : 1.0F;
    }
  }
}

}  // namespace eg::mapping
