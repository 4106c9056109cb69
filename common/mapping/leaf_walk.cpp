#include "common/mapping/leaf_walk.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace eg::mapping {
namespace {

// Leaf numbers are packed into 20 bits per axis, which at the smallest voxel size still spans kilometres.
constexpr int kAxisBits = 20;
constexpr std::int64_t kAxisOffset = std::int64_t{1} << (kAxisBits - 1);
constexpr int kRowsPerTask = 4;  // of blocks of pixels

std::uint64_t pack(const Eigen::Vector3i& leaf) {
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) key = key << kAxisBits | static_cast<std::uint64_t>(leaf[axis] + kAxisOffset);
  return key;
}

Eigen::Vector3i unpack(std::uint64_t key) {
  Eigen::Vector3i leaf;
  for (int axis = 2; axis >= 0; --axis, key >>= kAxisBits) {
    leaf[axis] = static_cast<int>(static_cast<std::int64_t>(key & ((1U << kAxisBits) - 1)) - kAxisOffset);
  }
  return leaf;
}

/// A list of leaves from which most repetitions are kept out by a small cache, for neighbouring pixels lie in the same
/// ones.
class LeafList {
 public:
  LeafList() { recent_.fill(std::numeric_limits<std::uint64_t>::max()); }

  void add(const Eigen::Vector3i& leaf) {
    const std::uint64_t key = pack(leaf);
    std::uint64_t& slot = recent_[(key ^ key >> 17 ^ key >> 34) % recent_.size()];
    if (slot == key) return;
    slot = key;
    keys_.push_back(key);
  }

  [[nodiscard]] const std::vector<std::uint64_t>& keys() const { return keys_; }

 private:
  std::array<std::uint64_t, 1024> recent_{};
  std::vector<std::uint64_t> keys_;
};

/// Solid angles of one camera, in units of leaves.
class Frustum {
 public:
  Frustum(const geometry::CameraModel& camera, const geometry::Pose& world_from_camera, double leaf_size)
      : origin_((world_from_camera.translation / leaf_size).cast<float>()) {
    Eigen::Matrix3d ray_from_pixel = Eigen::Matrix3d::Identity();
    ray_from_pixel.row(0) << 1.0 / camera.fx, 0.0, -camera.cx / camera.fx;
    ray_from_pixel.row(1) << 0.0, 1.0 / camera.fy, -camera.cy / camera.fy;
    direction_from_pixel_ = (world_from_camera.rotation * ray_from_pixel / leaf_size).cast<float>();
  }

  /// Adds the leaves that what the square of `side` pixels around (u, v) shows from depth `nearest` to `farthest` lies
  /// in. In pieces of half a leaf's length, whose bounding boxes reach little beyond them.
  void add_leaves(float u, float v, float side, float nearest, float farthest, LeafList& leaves) const {
    const Eigen::Array3f direction = direction_from_pixel_ * Eigen::Vector3f(u, v, 1.0F);
    const Eigen::Array3f spread = 0.5F * side * direction_from_pixel_.leftCols<2>().cwiseAbs().rowwise().sum();
    const Eigen::Array3f low = direction - spread;
    const Eigen::Array3f high = direction + spread;
    if (!is_inside(origin_ + farthest * low) || !is_inside(origin_ + farthest * high)) return;
    const float length = (farthest - nearest) * direction.matrix().norm();
    const int pieces = std::max(1, static_cast<int>(std::ceil(2.0F * length)));
    const float step = (farthest - nearest) / static_cast<float>(pieces);
    for (int i = 0; i < pieces; ++i) {
      const float from = nearest + static_cast<float>(i) * step;
      const float to = from + step;
      add_box(origin_ + (from * low).min(to * low), origin_ + (from * high).max(to * high), leaves);
    }
  }

 private:
  static bool is_inside(const Eigen::Array3f& point) {
    return point.abs().maxCoeff() < static_cast<float>(kAxisOffset - 2);  // false for NaN
  }

  static void add_box(const Eigen::Array3f& low, const Eigen::Array3f& high, LeafList& leaves) {
    const Eigen::Array3i first = low.floor().cast<int>();
    const Eigen::Array3i last = high.floor().cast<int>();
    for (int x = first.x(); x <= last.x(); ++x) {
      for (int y = first.y(); y <= last.y(); ++y) {
        for (int z = first.z(); z <= last.z(); ++z) leaves.add({x, y, z});
      }
    }
  }

  Eigen::Array3f origin_;
  Eigen::Matrix3f direction_from_pixel_;  ///< of (u, v, 1); scaled so that depth in metres is the parameter
};

/// Adds the leaves of the blocks of one row of the view.
class RowWalk {
 public:
  RowWalk(const DepthView& view, const Frustum& frustum, const TsdfOptions& options, LeafList& leaves)
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
    float low = std::numeric_limits<float>::max();
    float high = 0.0F;
    for (int y = kBlock * block_y; y < kBlock * (block_y + 1); ++y) {
      for (int x = kBlock * block_x; x < kBlock * (block_x + 1); ++x) {
        const float inverse = view_.inverse_depth(x, y);
        if (inverse == 0.0F) continue;
        low = std::min(low, inverse);
        high = std::max(high, inverse);
      }
    }
    constexpr float kCentre = 0.5F * (kBlock - 1);
    add(static_cast<float>(kBlock * block_x) + kCentre, static_cast<float>(kBlock * block_y) + kCentre, kBlock,
        1.0F / high, 1.0F / low, view_.obliqueness(block_x, block_y));
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
  LeafList& leaves_;
};

}  // namespace

std::vector<Eigen::Vector3i> leaves_near_surface(const DepthView& view, const geometry::CameraModel& camera,
                                                 const geometry::Pose& world_from_camera, const TsdfOptions& options,
                                                 int leaf_side) {
  const Frustum frustum(camera, world_from_camera, options.voxel_size * leaf_side);
  std::vector<std::vector<std::uint64_t>> keys_of_task(
      static_cast<std::size_t>((view.blocks_y() + kRowsPerTask - 1) / kRowsPerTask));
  tbb::parallel_for(std::size_t{0}, keys_of_task.size(), [&](std::size_t task) {
    LeafList leaves;
    RowWalk walk(view, frustum, options, leaves);
    const int first_row = static_cast<int>(task) * kRowsPerTask;
    for (int y = first_row; y < std::min(first_row + kRowsPerTask, view.blocks_y()); ++y) walk.add_row(y);
    keys_of_task[task] = leaves.keys();
  });

  std::vector<std::uint64_t> keys;
  for (const auto& some : keys_of_task) keys.insert(keys.end(), some.begin(), some.end());
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  std::vector<Eigen::Vector3i> leaves(keys.size());
  std::transform(keys.begin(), keys.end(), leaves.begin(), unpack);
  return leaves;
}

}  // namespace eg::mapping
