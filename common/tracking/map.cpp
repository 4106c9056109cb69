#include "common/tracking/map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/tracking/segment_error.hpp"

namespace eg::tracking {
namespace {

using features::FrameFeatures;
using features::LineFeature;
using features::PointFeature;
using geometry::Pose;

/// A feature expected at least this often and found in less than this share of the frames is culled.
constexpr int kMinExpected = 20;
constexpr double kMinFoundRatio = 0.25;
/// A line that so many keyframes saw is there: it is hidden, or breaks into other pieces from here.
constexpr int kConfirmingViews = 2;
/// Floor on a map point's variance (0.5 mm): what calibration leaves even after many views.
constexpr double kMinVariance = 2.5e-7;

Eigen::Matrix3d point_covariance(const PointFeature& point, const geometry::CameraModel& camera) {
  const Eigen::Vector3d ray = camera.ray(point.pixel);
  const Eigen::Vector3d lateral(point.pixel_sigma * point.depth / camera.fx,
                                point.pixel_sigma * point.depth / std::abs(camera.fy), 0.0);
  return lateral.cwiseAbs2().asDiagonal().toDenseMatrix() +
         point.depth_sigma * point.depth_sigma * ray * ray.transpose();
}

/// Kalman update of a position by a measured one.
void fuse_position(Eigen::Vector3d& position, Eigen::Matrix3d& covariance, const Eigen::Vector3d& measured,
                   const Eigen::Matrix3d& measured_covariance) {
  const Eigen::Matrix3d gain = covariance * (covariance + measured_covariance).inverse();
  position += gain * (measured - position);
  const Eigen::Matrix3d posterior = (Eigen::Matrix3d::Identity() - gain) * covariance;
  covariance = 0.5 * (posterior + posterior.transpose()) + kMinVariance * Eigen::Matrix3d::Identity();
}

template <typename MapId>
void note_observers(std::span<const Match<MapId>> matches, KeyframeId keyframe, std::size_t landmarks,
                    std::vector<std::vector<Observer>>& observers) {
  observers.resize(landmarks);
  for (const Match<MapId>& match : matches) {
    observers[static_cast<std::size_t>(match.id.value)].push_back({keyframe, match.feature});
  }
}

bool is_rarely_found(const Visibility& visibility) {
  return visibility.expected >= kMinExpected && visibility.found < kMinFoundRatio * visibility.expected;
}

}  // namespace

KeyframeId Map::add_keyframe(const FrameFeatures& features, const Pose& world_from_camera, const Matches& matches,
                             std::span<const egraph::Association> directions) {
  const KeyframeId id{static_cast<std::int32_t>(keyframes_.size())};
  keyframes_.push_back({id, features, world_from_camera, matches, {directions.begin(), directions.end()}});
  add_points(keyframes_.back());
  add_lines(keyframes_.back());
  add_planes(keyframes_.back());
  note_observers<PointId>(keyframes_.back().matches.points, id, points_.size(), point_observers_);
  note_observers<LineId>(keyframes_.back().matches.lines, id, lines_.size(), line_observers_);
  note_observers<PlaneId>(keyframes_.back().matches.planes, id, planes_.size(), plane_observers_);
  return id;
}

void Map::add_points(MapKeyframe& keyframe) {
  const Pose& pose = keyframe.world_from_camera;
  const geometry::CameraModel& camera = keyframe.features.camera;
  std::vector<bool> matched(keyframe.features.points.size(), false);
  for (const PointMatch& match : keyframe.matches.points) {
    matched[static_cast<std::size_t>(match.feature)] = true;
    const PointFeature& feature = keyframe.features.points[static_cast<std::size_t>(match.feature)];
    MapPoint& point = points_[static_cast<std::size_t>(match.id.value)];
    ++point.observations;
    point.descriptor = feature.descriptor;
    if (!feature.has_depth()) continue;
    const Eigen::Matrix3d covariance = pose.rotation * point_covariance(feature, camera) * pose.rotation.transpose();
    fuse_position(point.position, point.covariance, pose * camera.unproject(feature.pixel, feature.depth), covariance);
  }
  for (std::size_t i = 0; i < matched.size(); ++i) {
    const PointFeature& feature = keyframe.features.points[i];
    if (matched[i] || !feature.has_depth()) continue;
    MapPoint point;
    point.id = PointId{static_cast<std::int32_t>(points_.size())};
    point.position = pose * camera.unproject(feature.pixel, feature.depth);
    point.covariance = pose.rotation * point_covariance(feature, camera) * pose.rotation.transpose();
    const Eigen::Vector3d to_camera = pose.translation - point.position;
    point.viewed_from = to_camera.normalized();
    point.reference_distance = to_camera.norm() * std::pow(kPyramidScale, feature.octave);
    point.descriptor = feature.descriptor;
    point.track_id = feature.track_id;
    point.first_seen = keyframe.id;
    point.observations = 1;
    points_.push_back(point);
    point_index_.add(point.id, point.position);
    keyframe.matches.points.push_back({static_cast<std::int32_t>(i), point.id});
  }
}

void Map::add_lines(MapKeyframe& keyframe) {
  const Pose& pose = keyframe.world_from_camera;
  const auto in_world = [&](const Eigen::Matrix3d& c) { return pose.rotation * c * pose.rotation.transpose(); };
  std::vector<bool> matched(keyframe.features.lines.size(), false);
  for (const LineMatch& match : keyframe.matches.lines) {
    matched[static_cast<std::size_t>(match.feature)] = true;
    const LineFeature& feature = keyframe.features.lines[static_cast<std::size_t>(match.feature)];
    MapLine& line = lines_[static_cast<std::size_t>(match.id.value)];
    ++line.observations;
    line.descriptor = feature.descriptor;
    if (!feature.has_depth) continue;
    // End points slide along a line from view to view: only the part across the line is a measurement of them.
    const Eigen::Vector3d a = pose * feature.start;
    const Eigen::Vector3d b = pose * feature.end;
    const auto fuse_end = [&](Eigen::Vector3d& end, Eigen::Matrix3d& covariance) {
      const double place = place_along(a, b, end);
      fuse_position(end, covariance, a + place * (b - a),
                    in_world(variance_along(feature.start_covariance, feature.end_covariance, place)));
    };
    fuse_end(line.start, line.start_covariance);
    fuse_end(line.end, line.end_covariance);
  }
  for (std::size_t i = 0; i < matched.size(); ++i) {
    const LineFeature& feature = keyframe.features.lines[i];
    if (matched[i] || !feature.has_depth) continue;
    MapLine line;
    line.id = LineId{static_cast<std::int32_t>(lines_.size())};
    line.start = pose * feature.start;
    line.end = pose * feature.end;
    line.start_covariance = in_world(feature.start_covariance);
    line.end_covariance = in_world(feature.end_covariance);
    line.descriptor = feature.descriptor;
    line.track_id = feature.track_id;
    line.first_seen = keyframe.id;
    line.observations = 1;
    const Eigen::Vector3d middle = 0.5 * (line.start + line.end);
    line.viewed_from = (pose.translation - middle).normalized();
    lines_.push_back(line);
    line_index_.add(line.id, middle);
    keyframe.matches.lines.push_back({static_cast<std::int32_t>(i), line.id});
  }
}

void Map::add_planes(MapKeyframe& keyframe) {
  std::vector<bool> matched(keyframe.features.planes.size(), false);
  const auto measured_in_world = [&](std::size_t i) {
    const features::PlaneFeature& feature = keyframe.features.planes[i];
    return transform(keyframe.world_from_camera, PlaneEstimate{feature.plane, feature.covariance});
  };
  for (const PlaneMatch& match : keyframe.matches.planes) {
    matched[static_cast<std::size_t>(match.feature)] = true;
    MapPlane& plane = planes_[static_cast<std::size_t>(match.id.value)];
    fuse(plane.estimate, measured_in_world(static_cast<std::size_t>(match.feature)));
    ++plane.observations;
  }
  for (std::size_t i = 0; i < matched.size(); ++i) {
    if (matched[i]) continue;
    const PlaneId id{static_cast<std::int32_t>(planes_.size())};
    planes_.push_back({id, measured_in_world(i), keyframe.id, 1});
    keyframe.matches.planes.push_back({static_cast<std::int32_t>(i), id});
  }
}

std::vector<PointId> Map::points_near(const geometry::CameraModel& camera, const Pose& camera_from_world) const {
  return point_index_.near(camera, camera_from_world);
}

std::vector<LineId> Map::lines_near(const geometry::CameraModel& camera, const Pose& camera_from_world) const {
  return line_index_.near(camera, camera_from_world);
}

void Map::count_visibility(std::span<const PointId> expected_points, std::span<const LineId> expected_lines,
                           const Matches& found) {
  for (const PointMatch& match : found.points) ++points_[static_cast<std::size_t>(match.id.value)].visibility.found;
  for (const LineMatch& match : found.lines) ++lines_[static_cast<std::size_t>(match.id.value)].visibility.found;
  for (const PointId id : expected_points) {
    Visibility& visibility = points_[static_cast<std::size_t>(id.value)].visibility;
    ++visibility.expected;
    if (is_rarely_found(visibility)) cull(id);
  }
  for (const LineId id : expected_lines) {
    MapLine& line = lines_[static_cast<std::size_t>(id.value)];
    ++line.visibility.expected;
    if (is_rarely_found(line.visibility) && line.observations < kConfirmingViews) cull(id);
  }
}

std::vector<egraph::Covisibility> Map::covisible(KeyframeId id) const {
  std::map<KeyframeId, std::int32_t> shared;
  const Matches& matches = keyframe(id).matches;
  const auto count = [&](const auto& observers, const auto& list) {
    for (const auto& match : list) {
      for (const Observer& other : observers[static_cast<std::size_t>(match.id.value)]) ++shared[other.keyframe];
    }
  };
  count(point_observers_, matches.points);
  count(line_observers_, matches.lines);
  count(plane_observers_, matches.planes);
  shared.erase(id);
  std::vector<egraph::Covisibility> covisible;
  for (const auto& [other, number] : shared) covisible.push_back({other, number});
  std::stable_sort(covisible.begin(), covisible.end(),
                   [](const auto& a, const auto& b) { return a.shared_features > b.shared_features; });
  return covisible;
}

void Map::move_keyframe(KeyframeId id, const Pose& world_from_camera) {
  keyframes_[static_cast<std::size_t>(id.value)].world_from_camera = world_from_camera;
}
void Map::move_keyframe_and_what_it_alone_saw(KeyframeId id, const Pose& world_from_camera) {
  const MapKeyframe& keyframe = this->keyframe(id);
  const Pose step = world_from_camera * keyframe.world_from_camera.inverse();
  for (const PointMatch& match : keyframe.matches.points) {
    if (observers(match.id).size() == 1) move_point(match.id, step * point(match.id).position);
  }
  for (const LineMatch& match : keyframe.matches.lines) {
    if (observers(match.id).size() == 1) move_line(match.id, step * line(match.id).start, step * line(match.id).end);
  }
  for (const PlaneMatch& match : keyframe.matches.planes) {
    if (observers(match.id).size() == 1)
      move_plane(match.id, geometry::transform(step, plane(match.id).estimate.plane));
  }
  move_keyframe(id, world_from_camera);
}
void Map::move_point(PointId id, const Eigen::Vector3d& position) {
  points_[static_cast<std::size_t>(id.value)].position = position;
}
void Map::move_line(LineId id, const Eigen::Vector3d& start, const Eigen::Vector3d& end) {
  lines_[static_cast<std::size_t>(id.value)].start = start;
  lines_[static_cast<std::size_t>(id.value)].end = end;
}
void Map::move_plane(PlaneId id, const geometry::Plane& plane) {
  planes_[static_cast<std::size_t>(id.value)].estimate.plane = plane;
}

void Map::cull(PointId id) {
  points_[static_cast<std::size_t>(id.value)].alive = false;
  point_index_.remove(id);
}
void Map::cull(LineId id) {
  lines_[static_cast<std::size_t>(id.value)].alive = false;
  line_index_.remove(id);
}

}  // namespace eg::tracking
