#include "common/tracking/matcher.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include "common/geometry/so3.hpp"
#include "common/tracking/feature_grid.hpp"

namespace eg::tracking {
namespace {

using features::FrameFeatures;
using features::LineFeature;
using features::PointFeature;
using geometry::Pose;

/// Nearest depth (metres) at which a feature is expected to be visible.
constexpr double kMinDepth = 0.2;
/// A corner seen from more than 60° aside of where it was made no longer looks alike.
constexpr double kMinViewCosine = 0.5;

struct Expected {
  Eigen::Vector2d pixel;
  double octave = 0.0;
};

std::optional<Expected> expect_point(const MapPoint& point, const geometry::CameraModel& camera,
                                     const Pose& camera_from_world, const Eigen::Vector3d& camera_in_world) {
  const Eigen::Vector3d in_camera = camera_from_world * point.position;
  if (in_camera.z() < kMinDepth) return std::nullopt;
  const Eigen::Vector2d pixel = camera.project(in_camera);
  if (!camera.contains(pixel)) return std::nullopt;
  const Eigen::Vector3d to_camera = camera_in_world - point.position;
  const double distance = to_camera.norm();
  if (to_camera.dot(point.viewed_from) < kMinViewCosine * distance) return std::nullopt;
  return Expected{pixel, std::log(point.reference_distance / distance) / std::log(kPyramidScale)};
}

/// Keeps, of all matches of one feature, the one with the smallest distance.
template <typename Id>
class OneToOne {
 public:
  explicit OneToOne(std::size_t features) : best_(features) {}

  void offer(std::int32_t feature, Id id, double distance) {
    auto& best = best_[static_cast<std::size_t>(feature)];
    if (!best.second.valid() || distance < best.first) best = {distance, id};
  }
  [[nodiscard]] std::vector<Match<Id>> matches() const {
    std::vector<Match<Id>> matches;
    for (std::size_t i = 0; i < best_.size(); ++i) {
      if (best_[i].second.valid()) matches.push_back({static_cast<std::int32_t>(i), best_[i].second});
    }
    return matches;
  }

 private:
  std::vector<std::pair<double, Id>> best_;
};

/// Features by track id, for feature-level data with known correspondences.
template <typename Features>
std::map<std::int32_t, std::int32_t> index_by_track(const Features& features) {
  std::map<std::int32_t, std::int32_t> index;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (features[i].track_id >= 0) index[features[i].track_id] = static_cast<std::int32_t>(i);
  }
  return index;
}

struct BestTwo {
  std::int32_t feature = -1;
  int distance = 257;
  int second_distance = 257;

  void offer(std::int32_t candidate, int candidate_distance) {
    if (candidate_distance < distance) {
      second_distance = distance;
      distance = candidate_distance;
      feature = candidate;
    } else {
      second_distance = std::min(second_distance, candidate_distance);
    }
  }
  [[nodiscard]] bool distinct(const MatchOptions& options) const {
    return feature >= 0 && distance <= options.max_descriptor_distance &&
           distance <= options.max_distance_ratio * second_distance;
  }
};

struct Segment {
  Eigen::Vector2d start;
  Eigen::Vector2d end;
};

/// The part of a map segment in front of the camera, projected.
std::optional<Segment> project_segment(const MapLine& line, const geometry::CameraModel& camera,
                                       const Pose& camera_from_world) {
  Eigen::Vector3d a = camera_from_world * line.start;
  Eigen::Vector3d b = camera_from_world * line.end;
  if (a.z() < kMinDepth && b.z() < kMinDepth) return std::nullopt;
  if (a.z() < kMinDepth) a = b + (b.z() - kMinDepth) / (b.z() - a.z()) * (a - b);
  if (b.z() < kMinDepth) b = a + (a.z() - kMinDepth) / (a.z() - b.z()) * (b - a);
  return Segment{camera.project(a), camera.project(b)};
}

/// How far the observed segment lies beside the predicted one, in pixels; nothing if they differ in direction or do not
/// overlap by half of the shorter one.
std::optional<double> lateral_distance(const LineFeature& observed, const Segment& predicted, double max_lateral,
                                       double min_cosine) {
  const double length = (predicted.end - predicted.start).norm();
  const Eigen::Vector2d along = (predicted.end - predicted.start) / length;
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Vector2d middle = 0.5 * (observed.start_pixel + observed.end_pixel);
  const double lateral = std::abs(across.dot(middle - predicted.start));
  if (!(lateral <= max_lateral)) return std::nullopt;
  const Eigen::Vector2d observed_along = (observed.end_pixel - observed.start_pixel).normalized();
  if (std::abs(along.dot(observed_along)) < min_cosine) return std::nullopt;
  const double s0 = along.dot(observed.start_pixel - predicted.start);
  const double s1 = along.dot(observed.end_pixel - predicted.start);
  const double overlap = std::min(length, std::max(s0, s1)) - std::max(0.0, std::min(s0, s1));
  if (overlap < 0.5 * std::min(length, observed.length_pixels())) return std::nullopt;
  return lateral;
}

}  // namespace

int hamming_distance(const features::Descriptor& a, const features::Descriptor& b) {
  int distance = 0;
  for (std::size_t i = 0; i < a.size(); i += 8) {
    std::uint64_t x = 0;
    std::uint64_t y = 0;
    std::memcpy(&x, a.data() + i, 8);
    std::memcpy(&y, b.data() + i, 8);
    distance += std::popcount(x ^ y);
  }
  return distance;
}

std::vector<PointMatch> match_points(const FrameFeatures& frame, const Map& map, std::span<const PointId> candidates,
                                     const Pose& camera_from_world, const MatchOptions& options) {
  const FeatureGrid grid(frame);
  const auto by_track = index_by_track(frame.points);
  const Eigen::Vector3d camera_in_world = camera_from_world.inverse().translation;
  OneToOne<PointId> one_to_one(frame.points.size());
  for (const PointId id : candidates) {
    const MapPoint& point = map.point(id);
    if (point.track_id >= 0) {
      const auto known = by_track.find(point.track_id);
      if (known != by_track.end()) one_to_one.offer(known->second, id, 0.0);
      continue;
    }
    const auto expected = expect_point(point, frame.camera, camera_from_world, camera_in_world);
    if (!expected) continue;
    const double radius = options.radius * std::pow(kPyramidScale, std::clamp(expected->octave, 0.0, 7.0));
    BestTwo best;
    for (const std::int32_t i : grid.within(expected->pixel, radius)) {
      const PointFeature& feature = frame.points[static_cast<std::size_t>(i)];
      if (std::abs(feature.octave - expected->octave) > 1.6) continue;
      best.offer(i, hamming_distance(feature.descriptor, point.descriptor));
    }
    if (best.distinct(options)) one_to_one.offer(best.feature, id, best.distance);
  }
  return one_to_one.matches();
}

std::vector<LineMatch> match_lines(const FrameFeatures& frame, const Map& map, std::span<const LineId> candidates,
                                   const Pose& camera_from_world, const MatchOptions& options) {
  const auto by_track = index_by_track(frame.lines);
  const double min_cosine = std::cos(options.max_line_angle);
  OneToOne<LineId> one_to_one(frame.lines.size());
  for (const LineId id : candidates) {
    const MapLine& line = map.line(id);
    if (line.track_id >= 0) {
      const auto known = by_track.find(line.track_id);
      if (known != by_track.end()) one_to_one.offer(known->second, id, 0.0);
      continue;
    }
    const auto predicted = project_segment(line, frame.camera, camera_from_world);
    if (!predicted) continue;
    std::int32_t best = -1;
    double best_score = 1e9;
    for (std::size_t i = 0; i < frame.lines.size(); ++i) {
      const auto lateral = lateral_distance(frame.lines[i], *predicted, options.radius, min_cosine);
      if (!lateral) continue;
      const int distance = hamming_distance(frame.lines[i].descriptor, line.descriptor);
      if (distance > options.max_line_descriptor_distance) continue;
      const double score = distance + 2.0 * *lateral;
      if (score < best_score) {
        best_score = score;
        best = static_cast<std::int32_t>(i);
      }
    }
    if (best >= 0) one_to_one.offer(best, id, best_score);
  }
  return one_to_one.matches();
}

std::vector<PlaneMatch> match_planes(const FrameFeatures& frame, const Map& map, const Pose& camera_from_world,
                                     double position_sigma, const MatchOptions& options) {
  const Pose world_from_camera = camera_from_world.inverse();
  std::vector<PlaneMatch> matches;
  for (std::size_t i = 0; i < frame.planes.size(); ++i) {
    const features::PlaneFeature& feature = frame.planes[i];
    const PlaneEstimate observed{feature.plane, feature.covariance};
    const Eigen::Vector3d normal_in_world = world_from_camera.rotation * feature.plane.normal;
    const Eigen::Vector3d centroid_in_world = world_from_camera * feature.centroid;
    PlaneMatch best{static_cast<std::int32_t>(i), {}};
    double best_chi2 = options.max_plane_chi2;
    for (const MapPlane& plane : map.planes()) {
      const double cosine = normal_in_world.dot(plane.estimate.plane.normal);
      const double height = plane.estimate.plane.signed_distance(centroid_in_world);
      if (cosine < std::cos(options.max_plane_angle) || std::abs(height) > options.max_plane_distance) continue;
      const double variance = height_variance(plane.estimate, centroid_in_world) +
                              height_variance(observed, feature.centroid) + position_sigma * position_sigma;
      const double chi2 = height * height / variance;
      if (chi2 < best_chi2) {
        best_chi2 = chi2;
        best.id = plane.id;
      }
    }
    if (best.id.valid()) matches.push_back(best);
  }
  return matches;
}

std::vector<PointId> visible_points(const geometry::CameraModel& camera, const Map& map,
                                    std::span<const PointId> candidates, const Pose& camera_from_world) {
  const Eigen::Vector3d camera_in_world = camera_from_world.inverse().translation;
  std::vector<PointId> visible;
  for (const PointId id : candidates) {
    if (expect_point(map.point(id), camera, camera_from_world, camera_in_world)) visible.push_back(id);
  }
  return visible;
}

std::vector<PointMatch> match_points_by_descriptor(const FrameFeatures& frame, const Map& map,
                                                   const MapKeyframe& keyframe, const MatchOptions& options) {
  const auto by_track = index_by_track(frame.points);
  OneToOne<PointId> one_to_one(frame.points.size());
  for (const PointMatch& known : keyframe.matches.points) {
    const MapPoint& point = map.point(known.id);
    if (!point.alive) continue;
    if (point.track_id >= 0) {
      const auto same = by_track.find(point.track_id);
      if (same != by_track.end()) one_to_one.offer(same->second, known.id, 0.0);
      continue;
    }
    BestTwo best;
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      best.offer(static_cast<std::int32_t>(i), hamming_distance(frame.points[i].descriptor, point.descriptor));
    }
    if (best.distinct(options)) one_to_one.offer(best.feature, known.id, best.distance);
  }
  return one_to_one.matches();
}

}  // namespace eg::tracking
