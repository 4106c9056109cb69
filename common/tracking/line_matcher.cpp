#include <algorithm>
#include <cmath>

#include "common/tracking/matcher.hpp"
#include "common/tracking/one_to_one.hpp"
#include "common/tracking/visibility.hpp"

namespace eg::tracking {
namespace {

using features::FrameFeatures;
using features::LineFeature;
using geometry::Pose;

/// How far the middle of the observed segment lies beside the predicted line, in pixels.
double lateral_distance(const LineFeature& observed, const ImageSegment& predicted) {
  const Eigen::Vector2d along = (predicted.end - predicted.start).normalized();
  const Eigen::Vector2d across(-along.y(), along.x());
  return std::abs(across.dot(0.5 * (observed.start_pixel + observed.end_pixel) - predicted.start));
}

/// Whether the segments agree in direction and overlap by half of the shorter one.
bool lie_along(const LineFeature& observed, const ImageSegment& predicted, double min_cosine) {
  const double length = (predicted.end - predicted.start).norm();
  const Eigen::Vector2d along = (predicted.end - predicted.start) / length;
  const Eigen::Vector2d observed_along = (observed.end_pixel - observed.start_pixel).normalized();
  if (std::abs(along.dot(observed_along)) < min_cosine) return false;
  const double s0 = along.dot(observed.start_pixel - predicted.start);
  const double s1 = along.dot(observed.end_pixel - predicted.start);
  const double overlap = std::min(length, std::max(s0, s1)) - std::max(0.0, std::min(s0, s1));
  return overlap >= 0.5 * std::min(length, observed.length_pixels());
}

}  // namespace

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
      const double lateral = lateral_distance(frame.lines[i], *predicted);
      if (!(lateral <= options.radius) || !lie_along(frame.lines[i], *predicted, min_cosine)) continue;
      const int distance = hamming_distance(frame.lines[i].descriptor, line.descriptor);
      if (distance > options.max_line_descriptor_distance) continue;
      const double score = distance + 2.0 * lateral;
      if (score < best_score) {
        best_score = score;
        best = static_cast<std::int32_t>(i);
      }
    }
    if (best >= 0) one_to_one.offer(best, id, best_score);
  }
  return one_to_one.matches();
}

}  // namespace eg::tracking
