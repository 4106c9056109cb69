#include "common/tracking/frame_problem.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "common/tracking/segment_error.hpp"

namespace eg::tracking {
namespace {

using geometry::Pose;

/// Floor (0.1 pixels squared): what was seen of a line that points at the camera is one place only.
constexpr double kMinImageVariance = 0.01;

/// Variance in the image (pixels²) that the covariance of a point makes at its place.
double image_variance(const Eigen::Matrix3d& covariance_in_camera, double depth, const geometry::CameraModel& camera) {
  const double lateral = 0.5 * (covariance_in_camera(0, 0) + covariance_in_camera(1, 1));
  return lateral * camera.fx * camera.fx / (depth * depth);
}

double end_image_variance(const Eigen::Vector3d& end_in_world, const Eigen::Matrix3d& covariance_in_world,
                          const Pose& camera_from_world, const geometry::CameraModel& camera) {
  const Eigen::Matrix3d& rotation = camera_from_world.rotation;
  const double depth = std::max(0.1, (camera_from_world * end_in_world).z());
  return image_variance(rotation * covariance_in_world * rotation.transpose(), depth, camera);
}

}  // namespace

Eigen::Vector3d image_line(const features::LineFeature& line) {
  const Eigen::Vector3d crossing = line.start_pixel.homogeneous().cross(line.end_pixel.homogeneous());
  return crossing / crossing.head<2>().norm();
}

Eigen::Matrix2d image_line_covariance(const features::LineFeature& line, const geometry::CameraModel& camera,
                                      const Pose& camera_from_world, const Eigen::Vector3d& start_in_world,
                                      const Eigen::Vector3d& end_in_world) {
  const auto place_of = [&](const Eigen::Vector3d& in_camera) {
    if (in_camera.z() <= kNearestProjection) return 0.0;  // such a line has no residual
    return place_along(line.start_pixel, line.end_pixel, camera.project(in_camera));
  };
  const Eigen::Vector2d places(place_of(camera_from_world * start_in_world),
                               place_of(camera_from_world * end_in_world));
  constexpr double kVariance = kLinePixelSigma * kLinePixelSigma;
  return covariance_along(kVariance, kVariance, places) + kMinImageVariance * Eigen::Matrix2d::Identity();
}

std::vector<PointFactor> point_factors(const features::FrameFeatures& frame, const Map& map,
                                       std::span<const PointMatch> matches, const Pose& camera_from_world) {
  std::vector<PointFactor> factors;
  factors.reserve(matches.size());
  for (const PointMatch& match : matches) {
    const features::PointFeature& feature = frame.points[static_cast<std::size_t>(match.feature)];
    const MapPoint& point = map.point(match.id);
    const Eigen::Matrix3d covariance =
        camera_from_world.rotation * point.covariance * camera_from_world.rotation.transpose();
    const double depth = std::max(0.1, (camera_from_world * point.position).z());
    PointFactor factor;
    factor.point_in_world = point.position;
    factor.pixel = feature.pixel;
    factor.pixel_sigma =
        std::sqrt(feature.pixel_sigma * feature.pixel_sigma + image_variance(covariance, depth, frame.camera));
    factor.depth = feature.depth;
    factor.depth_sigma = std::sqrt(feature.depth_sigma * feature.depth_sigma + covariance(2, 2));
    factors.push_back(factor);
  }
  return factors;
}

std::vector<LineFactor> line_factors(const features::FrameFeatures& frame, const Map& map,
                                     std::span<const LineMatch> matches, const Pose& camera_from_world) {
  std::vector<LineFactor> factors;
  factors.reserve(matches.size());
  for (const LineMatch& match : matches) {
    const features::LineFeature& feature = frame.lines[static_cast<std::size_t>(match.feature)];
    const MapLine& line = map.line(match.id);
    const Eigen::Vector2d map_variance(
        end_image_variance(line.start, line.start_covariance, camera_from_world, frame.camera),
        end_image_variance(line.end, line.end_covariance, camera_from_world, frame.camera));
    const Eigen::Matrix2d seen = image_line_covariance(feature, frame.camera, camera_from_world, line.start, line.end);
    const Eigen::Matrix2d covariance = seen + map_variance.asDiagonal().toDenseMatrix();
    factors.push_back({line.start, line.end, image_line(feature), whitener(covariance)});
  }
  return factors;
}

std::vector<PlaneFactor> plane_factors(const features::FrameFeatures& frame, const Map& map,
                                       std::span<const PlaneMatch> matches, const Pose& camera_from_world) {
  const Pose world_from_camera = camera_from_world.inverse();
  std::vector<PlaneFactor> factors;
  factors.reserve(matches.size());
  for (const PlaneMatch& match : matches) {
    const features::PlaneFeature& feature = frame.planes[static_cast<std::size_t>(match.feature)];
    const PlaneEstimate& plane = map.plane(match.id).estimate;
    const double variance = height_variance(plane, world_from_camera * feature.centroid) +
                            height_variance({feature.plane, feature.covariance}, feature.centroid) +
                            kPlaneHeightFloor * kPlaneHeightFloor;
    factors.push_back({plane.plane, feature.centroid, std::sqrt(variance)});
  }
  return factors;
}

std::vector<DirectionFactor> direction_factors(const features::FrameFeatures& frame, const egraph::Graph& graph,
                                               std::span<const egraph::Association> associations,
                                               const Eigen::Matrix3d& camera_from_world_rotation) {
  std::vector<DirectionFactor> factors;
  factors.reserve(associations.size());
  for (const egraph::Association& association : associations) {
    const features::DirectionFeature& feature = frame.directions[association.feature];
    const egraph::DirectionLandmark& landmark = *graph.find_landmark(association.landmark);
    factors.push_back({landmark.direction, association.sign * feature.direction,
                       feature.covariance +
                           camera_from_world_rotation * landmark.covariance * camera_from_world_rotation.transpose()});
  }
  return factors;
}

}  // namespace eg::tracking
