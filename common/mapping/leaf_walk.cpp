#include "common/mapping/leaf_walk.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

#include "common/mapping/number_list.hpp"
#include "common/mapping/vector4.hpp"

namespace eg::mapping {
namespace {

constexpr int kRowsPerTask = 4;  // of blocks of pixels

using Keys = std::vector<std::uint64_t>;  // packed numbers, ascending, each once

Keys united(const Keys& a, const Keys& b) {
  Keys both;
  both.reserve(a.size() + b.size());
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

/// Solid angles of one camera, in units of leaves.
class Frustum {
 public:
  Frustum(const geometry::CameraModel& camera, const geometry::Pose& world_from_camera, double leaf_size)
      : origin_(widened((world_from_camera.translation / leaf_size).cast<float>())) {
    Eigen::Matrix3d ray_from_pixel = Eigen::Matrix3d::Identity();
    ray_from_pixel.row(0) << 1.0 / camera.fx, 0.0, -camera.cx / camera.fx;
    ray_from_pixel.row(1) << 0.0, 1.0 / camera.fy, -camera.cy / camera.fy;
    direction_from_pixel_ = (world_from_camera.rotation * ray_from_pixel / leaf_size).cast<float>();
  }

  /// Adds the leaves that what the square of `side` pixels around (u, v) shows from depth `nearest` to `farthest` lies
  /// in. In pieces of half a leaf's length, whose bounding boxes reach little beyond them.
  void add_leaves(float u, float v, float side, float nearest, float farthest, NumberList& leaves) const {
    const Eigen::Array3f direction = direction_from_pixel_ * Eigen::Vector3f(u, v, 1.0F);
    const Eigen::Array3f spread = 0.5F * side * direction_from_pixel_.leftCols<2>().cwiseAbs().rowwise().sum();
    const Float4 low = widened(direction - spread);
    const Float4 high = widened(direction + spread);
    if (!is_inside(origin_ + farthest * low) || !is_inside(origin_ + farthest * high)) return;
    const float length = (farthest - nearest) * direction.matrix().norm();
    const int pieces = std::max(1, static_cast<int>(std::ceil(2.0F * length)));
    const float step = (farthest - nearest) / static_cast<float>(pieces);
    Box last_box{{1, 0, 0, 0}, {}};  // empty
    for (int i = 0; i < pieces; ++i) {
      const float from = nearest + static_cast<float>(i) * step;
      const float to = from + step;
      const Box box{floored(origin_ + min(from * low, to * low)), floored(origin_ + max(from * high, to * high))};
      if (any((box.first ^ last_box.first) | (box.last ^ last_box.last))) add_box(box, leaves);
      last_box = box;
    }
  }

 private:
  /// Numbers of leaves along x, y and z, both included.
  struct Box {
    Int4 first, last;
  };

  static Float4 widened(const Eigen::Array3f& values) { return Float4{values.x(), values.y(), values.z(), 0.0F}; }

  static Int4 floored(Float4 x) {
    const Int4 truncated = truncate(x);
    return truncated + (x < to_float(truncated));  // true is -1
  }

  static bool is_inside(Float4 point) {
    return !any(~(abs(point) < static_cast<float>(kAxisOffset - 2)));  // false for NaN
  }

  static void add_box(const Box& box, NumberList& leaves) {
    for (int x = box.first[0]; x <= box.last[0]; ++x) {
      for (int y = box.first[1]; y <= box.last[1]; ++y) {
        for (int z = box.first[2]; z <= box.last[2]; ++z) leaves.add({x, y, z});
      }
    }
  }

  Float4 origin_;
  Eigen::Matrix3f direction_from_pixel_;  ///< of (u, v, 1); scaled so that depth in metres is the parameter
};

/// Adds the leaves of the blocks of one row of the view.
class RowWalk {
 public:
  RowWalk(const DepthView& view, const Frustum& frustum, const TsdfOptions& options, NumberList& leaves)
      : view_(view), frustum_(frustum), options_(options), leaves_(leaves) {}

  void add_row(int block_y) {
    for (int block_x = 0; block_x < view_.blocks_x(); ++block_x) {
      if (view_.at_edge(block_x, block_y)) {
        add_pixels(block_x, block_y);
      } else {
        add_block(block_x, block_y);
      }
    }
  }

 private:
  static constexpr int kBlock = DepthView::kBlock;

  /// A block of one surface, perhaps with gaps.
  void add_block(int block_x, int block_y) {
    const DepthRange& range = view_.range(block_x, block_y);
    constexpr float kCentre = 0.5F * (kBlock - 1);
    add(static_cast<float>(kBlock * block_x) + kCentre, static_cast<float>(kBlock * block_y) + kCentre, kBlock,
        1.0F / range.high, 1.0F / range.low, view_.obliqueness(block_x, block_y));
  }

  /// A block with a depth edge, or hardly any reading.
  void add_pixels(int block_x, int block_y) {
    for (int y = kBlock * block_y; y < std::min(kBlock * (block_y + 1), view_.height()); ++y) {
      for (int x = kBlock * block_x; x < std::min(kBlock * (block_x + 1), view_.width()); ++x) {
        if (view_.inverse_depth(x, y) == 0.0F) continue;
        const float depth = 1.0F / view_.inverse_depth(x, y);
        add(static_cast<float>(x), static_cast<float>(y), 1.0F, depth, depth, view_.obliqueness(block_x, block_y));
      }
    }
  }

  void add(float u, float v, float side, float nearest, float farthest, float obliqueness) {
    const float reach = static_cast<float>(truncation(options_, static_cast<double>(farthest))) / obliqueness;
    frustum_.add_leaves(u, v, side, std::max(0.0F, nearest - reach), farthest + reach, leaves_);
  }

  const DepthView& view_;
  const Frustum& frustum_;
  const TsdfOptions& options_;
  NumberList& leaves_;
};

}  // namespace

std::vector<Eigen::Vector3i> leaves_near_surface(const DepthView& view, const geometry::CameraModel& camera,
                                                 const geometry::Pose& world_from_camera, const TsdfOptions& options,
                                                 int leaf_side) {
  const Frustum frustum(camera, world_from_camera, options.voxel_size * leaf_side);
  const auto walk_rows = [&](const tbb::blocked_range<int>& rows, const Keys& before) {
    NumberList leaves;
    RowWalk walk(view, frustum, options, leaves);
    for (int y = rows.begin(); y < rows.end(); ++y) walk.add_row(y);
    return united(before, std::move(leaves).sorted());
  };
  const tbb::blocked_range<int> rows(0, view.blocks_y(), kRowsPerTask);
  return unpacked(tbb::parallel_reduce(rows, Keys{}, walk_rows, united));
}

}  // namespace eg::mapping
