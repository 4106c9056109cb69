#include "common/observations/frame_features.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "common/base/random.hpp"
#include "common/features/direction_evidence.hpp"
#include "common/geometry/depth_noise.hpp"

namespace eg::observations {
namespace {

using features::DirectionEvidence;
using features::FrameFeatures;
using features::LineFeature;
using features::MeasuredLine;
using features::PointFeature;
using geometry::CameraModel;

constexpr double kShortestSpan = 1e-3;  // metres: below it a segment in space has no direction
constexpr double kMaxTurn = 0.3;        // radians: a direction in space known less well says nothing
constexpr double kNearest = 0.05;       // metres: the tracker's own limit on usable depths
constexpr std::uint64_t kFrameStride = 0x9e3779b97f4a7c15ULL;  // keeps the frames' seeds apart

std::vector<PointFeature> measure_points(const RecordedFrame& frame, std::size_t index, const CameraModel& camera,
                                         const SensorModel& sensor) {
  base::Random random(sensor.seed ^ (kFrameStride * (index + 1)));
  std::vector<PointFeature> points;
  points.reserve(frame.points.size());
  for (const PointObservation& seen : frame.points) {
    const double noise = random.normal();  // drawn for every observation: none depends on which others are used
    if (!camera.contains(seen.pixel)) continue;
    PointFeature point;
    point.pixel = seen.pixel;
    point.pixel_sigma = sensor.pixel_sigma;
    point.depth_sigma = geometry::depth_sigma(seen.true_depth);
    point.depth = seen.true_depth + (sensor.depth_noise ? noise * point.depth_sigma : 0.0);
    if (point.depth < kNearest) point.depth = point.depth_sigma = 0.0;
    point.track_id = seen.id;
    points.push_back(point);
  }
  return points;
}

/// Of an end point, from the noise of its two pixel coordinates and its depth.
Eigen::Matrix3d end_covariance(const Eigen::Vector3d& end, const CameraModel& camera, const SensorModel& sensor) {
  Eigen::Matrix3d root = Eigen::Matrix3d::Zero();  // columns: one standard deviation of u, v and depth
  root(0, 0) = sensor.pixel_sigma * end.z() / camera.fx;
  root(1, 1) = sensor.pixel_sigma * end.z() / camera.fy;
  root.col(2) = sensor.line_depth_sigma * end / end.z();
  return root * root.transpose();
}

/// The direction in space and how well the depths of the ends determine it, turning in the plane of camera and line.
void measure_direction(MeasuredLine& line, const CameraModel& camera, const SensorModel& sensor) {
  const Eigen::Vector3d span = line.feature.end - line.feature.start;
  if (span.norm() < kShortestSpan) return;
  const Eigen::Vector3d start_ray = camera.ray(line.segment.start);
  const Eigen::Vector3d end_ray = camera.ray(line.segment.end);
  line.direction = span.normalized();
  const Eigen::Vector3d sideways = start_ray.cross(end_ray).normalized().cross(line.direction);
  line.direction_sigma =
      sensor.line_depth_sigma * std::hypot(sideways.dot(start_ray), sideways.dot(end_ray)) / span.norm();
}

std::vector<MeasuredLine> measure_lines(const RecordedFrame& frame, const CameraModel& camera,
                                        const SensorModel& sensor) {
  std::vector<MeasuredLine> lines;
  lines.reserve(frame.lines.size());
  for (const LineObservation& seen : frame.lines) {
    if (!camera.contains(seen.start_pixel) || !camera.contains(seen.end_pixel)) continue;
    MeasuredLine line;
    line.segment = {seen.start_pixel, seen.end_pixel, sensor.pixel_sigma};
    line.feature.start_pixel = seen.start_pixel;
    line.feature.end_pixel = seen.end_pixel;
    line.feature.has_depth = seen.start_depth > kNearest && seen.end_depth > kNearest;
    line.feature.track_id = seen.id;
    if (line.feature.has_depth) {
      line.feature.start = camera.unproject(seen.start_pixel, seen.start_depth);
      line.feature.end = camera.unproject(seen.end_pixel, seen.end_depth);
      line.feature.start_covariance = end_covariance(line.feature.start, camera, sensor);
      line.feature.end_covariance = end_covariance(line.feature.end, camera, sensor);
      measure_direction(line, camera, sensor);
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

/// The direction of parallel lines: the vanishing point of their pixels and their directions in space, fused.
std::optional<features::DirectionEstimate> common_direction(const std::vector<const MeasuredLine*>& members,
                                                            const CameraModel& camera) {
  std::vector<DirectionEvidence> evidence;
  const MeasuredLine* best = nullptr;
  for (const MeasuredLine* line : members) {
    if (line->segment.length() < 2.0 * line->segment.sigma) continue;  // its noise is as long as itself
    evidence.push_back(make_evidence(*line, camera));
    const bool has_direction = line->direction_sigma > 0.0 && line->direction_sigma < kMaxTurn;
    evidence.back().has_depth = has_direction;
    if (has_direction && (best == nullptr || line->direction_sigma < best->direction_sigma)) best = line;
  }
  if (best == nullptr || evidence.size() < 2) return std::nullopt;
  std::vector<const DirectionEvidence*> all;
  for (const DirectionEvidence& line : evidence) all.push_back(&line);
  return fit_direction(all, best->direction);
}

std::vector<features::DirectionFeature> measure_directions(std::vector<MeasuredLine>& lines, const Recording& recording,
                                                           const CameraModel& camera, const SensorModel& sensor) {
  std::map<std::int32_t, std::vector<MeasuredLine*>> groups;
  for (MeasuredLine& line : lines) {
    const auto group = recording.line_groups.find(line.feature.track_id);
    if (group != recording.line_groups.end()) groups[group->second].push_back(&line);
  }
  std::vector<features::DirectionFeature> directions;
  for (const auto& [group, members] : groups) {
    const auto estimate = common_direction({members.begin(), members.end()}, camera);
    if (!estimate || estimate->max_sigma() > sensor.max_direction_sigma) continue;
    for (MeasuredLine* line : members) line->feature.direction = static_cast<std::int32_t>(directions.size());
    directions.push_back({features::DirectionKind::vanishing_direction, estimate->direction, estimate->covariance,
                          static_cast<std::int32_t>(members.size()), -1});
  }
  return directions;
}

}  // namespace

FrameFeatures features_of(const Recording& recording, std::size_t index, const CameraModel& camera,
                          const SensorModel& sensor) {
  const RecordedFrame& frame = recording.frames[index];
  FrameFeatures result;
  result.header.utime = std::llround(frame.time_s * 1e6);
  result.camera = camera;
  result.points = measure_points(frame, index, camera, sensor);
  std::vector<MeasuredLine> lines = measure_lines(frame, camera, sensor);
  result.directions = measure_directions(lines, recording, camera, sensor);
  for (const MeasuredLine& line : lines) result.lines.push_back(line.feature);
  return result;
}

}  // namespace eg::observations
