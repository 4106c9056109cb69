#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "common/geometry/pose.hpp"
#include "common/image/rgbd_frame.hpp"

namespace eg::eval {

struct DepthCloudOptions {
  double spacing = 0.005;  ///< side of the cubes of which each keeps one point, metres
  double max_depth = 0.0;  ///< farther readings are left out, metres; 0: none is
};

/// The points that depth images show, thinned: each cube of space keeps the first that comes, as it was read, so that
/// no surface is moved.
class DepthCloud {
 public:
  /// The spacing must be positive.
  explicit DepthCloud(const DepthCloudOptions& options);

  /// Readings that are not finite or above 0 are left out, and those kilometres away.
  void add(const image::RectifiedFrame& frame, const geometry::Pose& world_from_camera);

  [[nodiscard]] const std::vector<Eigen::Vector3f>& points() const { return points_; }                ///< world, metres
  [[nodiscard]] const std::vector<std::array<std::uint8_t, 3>>& colours() const { return colours_; }  ///< RGB

 private:
  DepthCloudOptions options_;
  std::unordered_set<std::uint64_t> cubes_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<std::array<std::uint8_t, 3>> colours_;
};

}  // namespace eg::eval
