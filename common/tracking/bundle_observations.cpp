#include "common/tracking/bundle_observations.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/tracking/frame_problem.hpp"
#include "common/tracking/robust_loss.hpp"
#include "common/tracking/segment_error.hpp"

namespace eg::tracking {
namespace {

/// Floor on the uncertainty of a normal (radians): the height floor over a region of a metre.
constexpr double kNormalFloor = kPlaneHeightFloor / 1.0;

/// Edge of a patch, pixels: the lens and calibration residuals of a depth camera change over such lengths.
constexpr double kPatchPixels = 80.0;

}  // namespace

std::vector<int> points_in_same_patch(const features::FrameFeatures& frame) {
  const int columns = static_cast<int>(frame.camera.width / kPatchPixels) + 1;
  const int rows = static_cast<int>(frame.camera.height / kPatchPixels) + 1;
  const auto patch_of = [&](const features::PointFeature& point) {
    const int column = std::clamp(static_cast<int>(point.pixel.x() / kPatchPixels), 0, columns - 1);
    const int row = std::clamp(static_cast<int>(point.pixel.y() / kPatchPixels), 0, rows - 1);
    return static_cast<std::size_t>(row * columns + column);
  };
  std::vector<int> in_patch(static_cast<std::size_t>(columns * rows), 0);
  for (const features::PointFeature& point : frame.points) in_patch[patch_of(point)] += point.has_depth() ? 1 : 0;
  std::vector<int> sharing;
  sharing.reserve(frame.points.size());
  for (const features::PointFeature& point : frame.points) sharing.push_back(in_patch[patch_of(point)]);
  return sharing;
}

PointFactor observed_point(const features::PointFeature& feature, const Eigen::Vector3d& point_in_world,
                           const geometry::Pose& camera_from_world, int sharing_depth_error) {
  PointFactor seen;
  seen.point_in_world = point_in_world;
  seen.pixel = feature.pixel;
  seen.pixel_sigma = feature.pixel_sigma;
  const double beyond = ((camera_from_world * point_in_world).z() - feature.depth) / feature.depth_sigma;
  if (!feature.has_depth() || beyond * beyond > kChi2One) return seen;
  seen.depth = feature.depth;
  seen.depth_sigma = feature.depth_sigma * std::sqrt(static_cast<double>(std::max(1, sharing_depth_error)));
  return seen;
}

LineObservation observed_line(const features::LineFeature& feature, const Eigen::Vector3d& start_in_world,
                              const Eigen::Vector3d& end_in_world, const geometry::CameraModel& camera,
                              const geometry::Pose& camera_from_world) {
  LineObservation seen;
  seen.image_line = image_line(feature);
  seen.image_whitener =
      whitener(image_line_covariance(feature, camera, camera_from_world, start_in_world, end_in_world));
  if (!feature.has_depth) return seen;
  const Eigen::Vector3d along = (feature.end - feature.start).normalized();
  const Eigen::Vector3d sideways = feature.start.cross(along).normalized();  // of the plane of line and camera centre
  seen.point_in_camera = feature.start;
  seen.inwards = along.cross(sideways);
  const Eigen::Vector3d start = camera_from_world * start_in_world;
  const Eigen::Vector3d end = camera_from_world * end_in_world;
  const Eigen::Vector2d places(place_along(feature.start, feature.end, start),
                               place_along(feature.start, feature.end, end));
  seen.inwards_whitener = whitener(covariance_along(seen.inwards.dot(feature.start_covariance * seen.inwards),
                                                    seen.inwards.dot(feature.end_covariance * seen.inwards), places) +
                                   kPlaneHeightFloor * kPlaneHeightFloor * Eigen::Matrix2d::Identity());
  const Eigen::Vector2d beyond(seen.inwards.dot(start - feature.start), seen.inwards.dot(end - feature.start));
  seen.has_depth = (seen.inwards_whitener * beyond).squaredNorm() <= kChi2Two;
  return seen;
}

PlaneObservation observed_plane(const features::PlaneFeature& feature) {
  PlaneObservation seen;
  seen.normal_in_camera = feature.plane.normal;
  seen.normal_covariance =
      feature.covariance.topLeftCorner<3, 3>() + kNormalFloor * kNormalFloor * Eigen::Matrix3d::Identity();
  seen.centroid_in_camera = feature.centroid;
  seen.height_sigma = std::sqrt(height_variance({feature.plane, feature.covariance}, feature.centroid) +
                                kPlaneHeightFloor * kPlaneHeightFloor);
  return seen;
}

}  // namespace eg::tracking
