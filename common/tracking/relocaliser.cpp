#include "common/tracking/relocaliser.hpp"

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "common/base/random.hpp"
#include "common/geometry/so3.hpp"
#include "common/tracking/frame_problem.hpp"

namespace eg::tracking {
namespace {

struct Correspondences {
  std::vector<Eigen::Vector3d> in_world;
  std::vector<Eigen::Vector3d> in_camera;
};

Correspondences with_depth(std::span<const PointFactor> factors, const geometry::CameraModel& camera) {
  Correspondences both;
  for (const PointFactor& factor : factors) {
    if (factor.depth <= 0.0) continue;
    both.in_world.push_back(factor.point_in_world);
    both.in_camera.push_back(camera.unproject(factor.pixel, factor.depth));
  }
  return both;
}

int count_inliers(std::span<const PointFactor> factors, const geometry::CameraModel& camera, const geometry::Pose& pose,
                  double inlier_chi2) {
  int inliers = 0;
  for (const PointFactor& factor : factors) {
    if (reprojection_chi2(factor, camera, pose) < inlier_chi2) ++inliers;
  }
  return inliers;
}

}  // namespace

geometry::Pose align_points(std::span<const Eigen::Vector3d> in_world, std::span<const Eigen::Vector3d> in_camera) {
  Eigen::Vector3d world_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d camera_mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < in_world.size(); ++i) {
    world_mean += in_world[i] / static_cast<double>(in_world.size());
    camera_mean += in_camera[i] / static_cast<double>(in_world.size());
  }
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < in_world.size(); ++i) {
    correlation += (in_camera[i] - camera_mean) * (in_world[i] - world_mean).transpose();
  }
  const Eigen::Matrix3d rotation = geometry::nearest_rotation(correlation);
  return {rotation, camera_mean - rotation * world_mean};
}

std::optional<geometry::Pose> relocalise(const features::FrameFeatures& frame, const Map& map,
                                         const MapKeyframe& keyframe, const RelocaliserOptions& options) {
  const auto matches = match_points_by_descriptor(frame, map, keyframe, options.matching);
  if (static_cast<int>(matches.size()) < options.min_inliers) return std::nullopt;
  const auto factors = point_factors(frame, map, matches, keyframe.world_from_camera.inverse());
  const Correspondences points = with_depth(factors, frame.camera);
  if (points.in_world.size() < 3) return std::nullopt;

  base::Random random(options.seed);
  const int count = static_cast<int>(points.in_world.size());
  int best_inliers = options.min_inliers - 1;
  std::optional<geometry::Pose> best;
  for (int sample = 0; sample < options.samples; ++sample) {
    std::array<Eigen::Vector3d, 3> in_world;
    std::array<Eigen::Vector3d, 3> in_camera;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto pick = static_cast<std::size_t>(random.index(count));
      in_world[i] = points.in_world[pick];
      in_camera[i] = points.in_camera[pick];
    }
    const double area = (in_world[1] - in_world[0]).cross(in_world[2] - in_world[0]).norm();
    if (area < 0.01) continue;  // 10 cm x 10 cm: smaller triangles turn with the noise of their depth
    const geometry::Pose pose = align_points(in_world, in_camera);
    const int inliers = count_inliers(factors, frame.camera, pose, options.inlier_chi2);
    if (inliers > best_inliers) {
      best_inliers = inliers;
      best = pose;
    }
  }
  return best;
}

}  // namespace eg::tracking
