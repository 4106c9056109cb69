#include "common/tracking/matcher.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "common/tracking/feature_grid.hpp"
#include "common/tracking/one_to_one.hpp"
#include "common/tracking/visibility.hpp"

namespace eg::tracking {
namespace {

using features::FrameFeatures;
using features::PointFeature;
using geometry::Pose;

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
  OneToOne<PointId> one_to_one(frame.points.size());
  for (const PointId id : candidates) {
    const MapPoint& point = map.point(id);
    if (point.track_id >= 0) {
      const auto known = by_track.find(point.track_id);
      if (known != by_track.end()) one_to_one.offer(known->second, id, 0.0);
      continue;
    }
    const auto expected = expect_point(point, frame.camera, camera_from_world);
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
