#include "common/mapping/leaf_walk.hpp"

#include <oneapi/tbb/blocked_range.h>
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
constexpr int kRowsPerTask = 16;

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

/// A list of leaves from which most repetitions are kept out by a small cache, for neighbouring rays cross the same
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

  [[nodiscard]] bool empty() const { return keys_.empty(); }
  [[nodiscard]] const std::vector<std::uint64_t>& keys() const { return keys_; }

 private:
  std::array<std::uint64_t, 1024> recent_{};
  std::vector<std::uint64_t> keys_;
};

/// The first and last leaf of a segment.
struct Ends {
  Eigen::Vector3i first = Eigen::Vector3i::Zero();
  Eigen::Vector3i last = Eigen::Vector3i::Zero();

  [[nodiscard]] int steps() const { return (last - first).cwiseAbs().sum(); }
  bool operator==(const Ends&) const = default;
};

/// Steps from cell to cell along a segment (Amanatides and Woo, Eurographics 1987), in units of leaves.
void walk_segment(const Eigen::Vector3f& from, const Eigen::Vector3f& to, const Ends& ends, LeafList& leaves) {
  Eigen::Vector3i cell = ends.first;
  const Eigen::Vector3i& last = ends.last;
  const Eigen::Vector3f direction = to - from;
  Eigen::Vector3i step;
  Eigen::Vector3f next;   // parameter in [0, 1] at which the ray leaves the cell, per axis
  Eigen::Vector3f delta;  // parameter per cell
  for (int axis = 0; axis < 3; ++axis) {
    step[axis] = direction[axis] > 0.0F ? 1 : -1;
    const bool still = cell[axis] == last[axis];
    const float border = static_cast<float>(cell[axis] + (step[axis] > 0 ? 1 : 0));
    next[axis] = still ? std::numeric_limits<float>::infinity() : (border - from[axis]) / direction[axis];
    delta[axis] = still ? std::numeric_limits<float>::infinity() : 1.0F / std::abs(direction[axis]);
  }
  leaves.add(cell);
  for (int remaining = ends.steps(); remaining > 0; --remaining) {
    int axis = 0;
    next.minCoeff(&axis);
    cell[axis] += step[axis];
    next[axis] = cell[axis] == last[axis] ? std::numeric_limits<float>::infinity() : next[axis] + delta[axis];
    leaves.add(cell);
  }
}

/// The rays of one camera, in units of leaves.
struct RayCaster {
  Eigen::Vector3f origin;
  Eigen::Matrix3f direction_from_pixel;  // of (u, v, 1); scaled so that depth in metres is the parameter
  float limit = static_cast<float>(kAxisOffset - 1);

  RayCaster(const geometry::CameraModel& camera, const geometry::Pose& world_from_camera, double leaf_size) {
    Eigen::Matrix3d ray_from_pixel = Eigen::Matrix3d::Identity();
    ray_from_pixel.row(0) << 1.0 / camera.fx, 0.0, -camera.cx / camera.fx;
    ray_from_pixel.row(1) << 0.0, 1.0 / camera.fy, -camera.cy / camera.fy;
    origin = (world_from_camera.translation / leaf_size).cast<float>();
    direction_from_pixel = (world_from_camera.rotation * ray_from_pixel / leaf_size).cast<float>();
  }

  /// `previous`: the ends of the last ray that was walked. With at most one step between them there is only one way, so
  /// that the next ray with the same ends, usually the neighbouring pixel's, adds nothing.
  void walk(int x, int y, float nearest, float farthest, Ends& previous, LeafList& leaves) const {
    const Eigen::Vector3f direction =
        direction_from_pixel * Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), 1);
    const Eigen::Vector3f from = origin + nearest * direction;
    const Eigen::Vector3f to = origin + farthest * direction;
    if (!(from.cwiseAbs().maxCoeff() < limit && to.cwiseAbs().maxCoeff() < limit)) return;
    const Ends ends{from.array().floor().cast<int>(), to.array().floor().cast<int>()};
    if (ends == previous && ends.steps() <= 1 && !leaves.empty()) return;
    previous = ends;
    walk_segment(from, to, ends, leaves);
  }
};

}  // namespace

std::vector<Eigen::Vector3i> leaves_near_surface(const DepthView& view, const geometry::CameraModel& camera,
                                                 const geometry::Pose& world_from_camera, const TsdfOptions& options,
                                                 int leaf_side) {
  const RayCaster rays(camera, world_from_camera, options.voxel_size * leaf_side);
  std::vector<std::vector<std::uint64_t>> keys_of_task(
      static_cast<std::size_t>((view.height() + kRowsPerTask - 1) / kRowsPerTask));
  tbb::parallel_for(std::size_t{0}, keys_of_task.size(), [&](std::size_t task) {
    LeafList leaves;
    Ends previous;
    const int first_row = static_cast<int>(task) * kRowsPerTask;
    for (int y = first_row; y < std::min(first_row + kRowsPerTask, view.height()); ++y) {
      for (int x = 0; x < view.width(); ++x) {
        const float inverse_depth = view.inverse_depth(x, y);
        if (inverse_depth == 0.0F) continue;
        const float depth = 1.0F / inverse_depth;
        const auto reach = static_cast<float>(truncation(options, depth)) / view.obliqueness(x, y);
        rays.walk(x, y, std::max(0.0F, depth - reach), depth + reach, previous, leaves);
      }
    }
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
