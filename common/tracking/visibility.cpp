#include "common/tracking/visibility.hpp"

#include <algorithm>
#include <cmath>

namespace eg::tracking {
namespace {

using geometry::CameraModel;
using geometry::Pose;

/// Nearest depth (metres) at which a feature is expected to be visible.
constexpr double kMinDepth = 0.2;
/// What is seen from more than 60° aside of where it was made no longer looks alike, or is hidden behind its wall.
constexpr double kMinViewCosine = 0.5;
/// A visible piece, as a share of the image's diagonal, that no detector misses: twice the shortest that it looks for.
constexpr double kMinVisibleShare = 0.07;

bool is_seen_from_its_side(const Eigen::Vector3d& to_camera, const Eigen::Vector3d& viewed_from) {
  return to_camera.dot(viewed_from) >= kMinViewCosine * to_camera.norm();
}

/// The length (pixels) of a segment within the picture: Liang and Barsky's clipping.
double length_inside(const ImageSegment& segment, const CameraModel& camera) {
  const Eigen::Vector2d along = segment.end - segment.start;
  const Eigen::Vector2d corner(camera.width - 1.0, camera.height - 1.0);
  double enters = 0.0;
  double leaves = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    if (along[axis] == 0.0) {
      if (segment.start[axis] < 0.0 || segment.start[axis] > corner[axis]) return 0.0;
      continue;
    }
    const double at_zero = -segment.start[axis] / along[axis];
    const double at_corner = (corner[axis] - segment.start[axis]) / along[axis];
    enters = std::max(enters, std::min(at_zero, at_corner));
    leaves = std::min(leaves, std::max(at_zero, at_corner));
  }
  return std::max(0.0, leaves - enters) * along.norm();
}

}  // namespace

std::optional<ExpectedPoint> expect_point(const MapPoint& point, const CameraModel& camera,
                                          const Pose& camera_from_world) {
  const Eigen::Vector3d in_camera = camera_from_world * point.position;
  if (in_camera.z() < kMinDepth) return std::nullopt;
  const Eigen::Vector2d pixel = camera.project(in_camera);
  if (!camera.contains(pixel)) return std::nullopt;
  const Eigen::Vector3d to_camera = camera_from_world.inverse().translation - point.position;
  if (!is_seen_from_its_side(to_camera, point.viewed_from)) return std::nullopt;
  return ExpectedPoint{pixel, std::log(point.reference_distance / to_camera.norm()) / std::log(kPyramidScale)};
}

std::optional<ImageSegment> project_segment(const MapLine& line, const CameraModel& camera,
                                            const Pose& camera_from_world) {
  Eigen::Vector3d a = camera_from_world * line.start;
  Eigen::Vector3d b = camera_from_world * line.end;
  if (a.z() < kMinDepth && b.z() < kMinDepth) return std::nullopt;
  if (a.z() < kMinDepth) a = b + (b.z() - kMinDepth) / (b.z() - a.z()) * (a - b);
  if (b.z() < kMinDepth) b = a + (a.z() - kMinDepth) / (a.z() - b.z()) * (b - a);
  return ImageSegment{camera.project(a), camera.project(b)};
}

std::vector<PointId> visible_points(const CameraModel& camera, const Map& map, std::span<const PointId> candidates,
                                    const Pose& camera_from_world) {
  std::vector<PointId> visible;
  for (const PointId id : candidates) {
    if (expect_point(map.point(id), camera, camera_from_world)) visible.push_back(id);
  }
  return visible;
}

std::vector<LineId> visible_lines(const CameraModel& camera, const Map& map, std::span<const LineId> candidates,
                                  const Pose& camera_from_world) {
  const Eigen::Vector3d camera_in_world = camera_from_world.inverse().translation;
  const double long_enough = kMinVisibleShare * std::hypot(camera.width, camera.height);
  std::vector<LineId> visible;
  for (const LineId id : candidates) {
    const MapLine& line = map.line(id);
    if (!is_seen_from_its_side(camera_in_world - 0.5 * (line.start + line.end), line.viewed_from)) continue;
    const auto segment = project_segment(line, camera, camera_from_world);
    if (segment && length_inside(*segment, camera) >= long_enough) visible.push_back(id);
  }
  return visible;
}

}  // namespace eg::tracking
