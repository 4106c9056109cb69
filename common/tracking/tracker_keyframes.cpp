#include <algorithm>
#include <cmath>

#include "common/tracking/pose_covariance.hpp"
#include "common/tracking/relative_poses.hpp"
#include "common/tracking/tracker_frame.hpp"

/// When a frame becomes a keyframe, and what then happens to the map.
namespace eg::tracking {
namespace {

using features::FrameFeatures;
using geometry::Pose;

/// The frame as a keyframe of the E-Graph.
egraph::Keyframe announcement(const FrameFeatures& features, const PoseEstimate& estimate) {
  egraph::Keyframe keyframe;
  keyframe.header = features.header;
  keyframe.id = estimate.keyframe;
  keyframe.world_from_camera = estimate.world_from_camera;
  keyframe.covariance = estimate.covariance;
  keyframe.directions = features.directions;
  for (const features::DirectionFeature& direction : keyframe.directions) {
    const bool is_plane = direction.kind == egraph::DirectionKind::plane_normal;
    keyframe.plane_distances.push_back(
        is_plane ? features.planes[static_cast<std::size_t>(direction.source)].plane.distance : NAN);
  }
  return keyframe;
}

}  // namespace

bool Tracker::sees_new_structure(const Frame& frame) const {
  if (frame.matches.planes.size() < frame.features.planes.size()) return true;
  if (!options_.parts.egraph) return false;  // no direction is ever known
  const auto known = [&](std::size_t feature) {
    return std::any_of(frame.associations.begin(), frame.associations.end(),
                       [&](const egraph::Association& association) { return association.feature == feature; });
  };
  for (std::size_t i = 0; i < frame.features.directions.size(); ++i) {
    if (frame.features.directions[i].kind == egraph::DirectionKind::vanishing_direction && !known(i)) return true;
  }
  return false;
}

int Tracker::features_of_last_keyframe(const Frame& frame) const {
  const MapKeyframe& last = map_.keyframes().back();
  std::vector<PointId> points;
  for (const PointMatch& match : last.matches.points) points.push_back(match.id);
  std::vector<LineId> lines;
  for (const LineMatch& match : last.matches.lines) lines.push_back(match.id);
  std::sort(points.begin(), points.end());
  std::sort(lines.begin(), lines.end());
  const auto found_points =
      std::count_if(frame.matches.points.begin(), frame.matches.points.end(),
                    [&](const auto& match) { return std::binary_search(points.begin(), points.end(), match.id); });
  const auto found_lines =
      std::count_if(frame.matches.lines.begin(), frame.matches.lines.end(),
                    [&](const auto& match) { return std::binary_search(lines.begin(), lines.end(), match.id); });
  return static_cast<int>(found_points + found_lines);
}

std::optional<DirectionViews> Tracker::direction_views(const Frame& frame) const {
  if (frame.associations.empty()) return std::nullopt;
  const PoseSolution by_map = without_directions(frame.problem, frame.solution);
  if (observability(by_map.information).rotation_sigma > options_.max_rotation_sigma) return std::nullopt;
  const Pose world_from_camera = by_map.camera_from_world.inverse();
  return DirectionViews{
      frame.features.directions, frame.associations, world_from_camera.rotation,
      world_covariance(by_map.information, frame.prediction, world_from_camera).topLeftCorner<3, 3>()};
}

void Tracker::add_keyframe(Frame& frame, TrackResult& result) {
  PoseEstimate& estimate = result.estimate;
  FrameFeatures features = frame.features;
  if (const auto views = direction_views(frame)) {
    AssociatedDirections seen = direction_tracks_.fuse(*views);
    features.directions = std::move(seen.directions);
    frame.associations = std::move(seen.associations);
  }
  direction_tracks_.clear();
  estimate.keyframe = map_.add_keyframe(features, estimate.world_from_camera, frame.matches, frame.associations);
  policy_.keyframe_added();
  if (options_.parts.local_bundle_adjustment) {
    result.corrections = adjust_local_map();
    estimate.world_from_camera = map_.keyframe(estimate.keyframe).world_from_camera;
    motion_.correct(estimate.world_from_camera.inverse());
  }
  result.keyframe = announcement(features, estimate);
  result.keyframe->covisible = map_.covisible(estimate.keyframe);
  result.keyframe->relative_poses = relative_poses(map_, estimate.keyframe, covariance_by_map(frame));
  report_moved_keyframes(*result.keyframe);
}

std::vector<PoseCorrection::Entry> Tracker::adjust_local_map() {
  const KeyframeId newest = map_.keyframes().back().id;
  const BundleSolution solution =
      adjust_bundle(map_, graph_, local_window(map_, newest, options_.bundle.window), options_.bundle);
  apply(solution, map_);
  std::vector<PoseCorrection::Entry> others;
  for (const auto& [id, pose] : solution.world_from_camera) {
    if (id != newest) others.push_back({id, pose});
  }
  return others;
}

}  // namespace eg::tracking
