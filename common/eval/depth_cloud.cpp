#include "common/eval/depth_cloud.hpp"

#include <cmath>
#include <optional>

#include "common/base/check.hpp"

namespace eg::eval {
namespace {

constexpr int kAxisBits = 21;
constexpr double kFarthest = 1 << (kAxisBits - 1);  // cubes from the origin

/// The number of the cube that a point lies in; none if it is too far away or not finite.
std::optional<std::uint64_t> cube_of(const Eigen::Vector3d& point_in_cubes) {
  if (!(point_in_cubes.cwiseAbs().maxCoeff() < kFarthest)) return std::nullopt;
  std::uint64_t cube = 0;
  for (int axis = 0; axis < 3; ++axis) {
    cube = cube << kAxisBits | static_cast<std::uint64_t>(std::floor(point_in_cubes[axis]) + kFarthest);
  }
  return cube;
}

}  // namespace

DepthCloud::DepthCloud(const DepthCloudOptions& options) : options_(options) {
  EG_CHECK(options.spacing > 0.0, "the spacing of a cloud is positive");
}

void DepthCloud::add(const image::RectifiedFrame& frame, const geometry::Pose& world_from_camera) {
  std::optional<std::uint64_t> last;
  for (int v = 0; v < frame.depth.rows; ++v) {
    for (int u = 0; u < frame.depth.cols; ++u) {
      const auto depth = static_cast<double>(frame.depth.at<float>(v, u));
      if (!(depth > 0.0) || (options_.max_depth > 0.0 && depth > options_.max_depth)) continue;
      const Eigen::Vector3d point = world_from_camera * frame.camera.unproject({u, v}, depth);
      const auto cube = cube_of(point / options_.spacing);
      if (!cube || cube == last) continue;  // that of the pixel beside it: no need to look it up
      last = cube;
      if (!cubes_.insert(*cube).second) continue;
      points_.push_back(point.cast<float>());
      const auto& bgr = frame.colour.at<cv::Vec3b>(v, u);
      colours_.push_back({bgr[2], bgr[1], bgr[0]});
    }
  }
}

}  // namespace eg::eval
