#include "common/tracking/tracker.hpp"

#include <algorithm>
#include <utility>

#include "common/base/check.hpp"
#include "common/tracking/one_to_one.hpp"
#include "common/tracking/pose_covariance.hpp"
#include "common/tracking/tracker_frame.hpp"
#include "common/tracking/visibility.hpp"

namespace eg::tracking {
namespace {

using features::FrameFeatures;
using geometry::Pose;

/// Floor on the rotation uncertainty of a keyframe (0.05°): correlated errors do not average out over features.
constexpr double kMinRotationVariance = 7.6e-7;

/// A landmark with a known identity is in view only where a feature bears its name.
template <typename Landmark>
bool is_hidden(const Landmark& landmark, const std::map<std::int32_t, std::int32_t>& names) {
  return landmark.track_id >= 0 && !names.contains(landmark.track_id);
}

}  // namespace

Tracker::Tracker(TrackerOptions options) : options_(options), motion_(options.motion), policy_(options.keyframes) {}

void Tracker::continue_in(Map map, egraph::Graph graph) {
  EG_CHECK(map_.empty() && !map.empty(), "a map is continued before the first frame, and has keyframes");
  map_ = std::move(map);
  graph_ = std::move(graph);
  for (const MapKeyframe& keyframe : map_.keyframes()) {
    EG_CHECK(graph_.find_keyframe(keyframe.id) != nullptr, "the graph of a map knows its keyframes");
  }
  lost_ = true;
  state_ = TrackingState::lost;
  last_measured_utime_ = -options_.max_blind_utime - 1;  // no last pose that says where to look
}

TrackResult Tracker::track(const FrameFeatures& features) {
  if (options_.parts.lines && options_.parts.planes) return track_parts(features);
  return track_parts(without_missing(features, options_.parts));
}

TrackResult Tracker::track_parts(const FrameFeatures& features) {
  if (std::string objection = time_objection(features.header.utime); !objection.empty()) {
    return refuse(features.header, std::move(objection));
  }
  if (map_.empty()) return initialise(features);
  const std::int64_t blind = features.header.utime - last_measured_utime_;
  if (lost_ && blind > options_.max_blind_utime) {
    return map_tells_no_pose() && tells_pose(features) ? begin_anew(features)
                                                       : recover(features, "searching for a known place");
  }

  Frame frame = estimate(features);
  if (points_contradict(frame)) return recover(features, "planes fit here, but none of the expected points");

  if (finds_much_less(frame)) {
    std::optional<Frame> place = find_known_place(features);
    if (place && 2 * found(frame) < found(*place)) return go_on_at_known_place(*place);
  }

  const Observability observed = observability(frame.solution.information);
  if (is_proven(frame) && observed.translation_sigma < options_.max_translation_sigma) {
    if (lost_) return finish(frame, TrackingState::relocalised, "found near the last pose");
    return finish(frame, TrackingState::tracking, "");
  }
  const bool rotation_is_proven = is_proven(frame) || directions_are_unmistakable(frame);
  if (rotation_is_proven && observed.rotation_sigma < options_.max_rotation_sigma) {
    return finish(frame, TrackingState::rotation_only, "matches do not determine the translation");
  }
  if (map_tells_no_pose() && tells_pose(features)) return begin_anew(frame);
  if (follows_one_wall(frame, observed)) {
    frame.unseen_turn = observed.worst_turn;
    return finish(frame, TrackingState::rotation_only, "a single direction in view: the turn about it is predicted");
  }
  if (goes_on_as_before(frame)) {
    return finish(frame, TrackingState::rotation_only, "matches and the motion so far together hold the rotation");
  }
  const bool empty = features.points.empty() && features.lines.empty() && features.planes.empty();
  return recover(features, empty ? "no feature in view" : "matches determine neither rotation nor translation");
}

std::string Tracker::time_objection(std::int64_t utime) {
  if (utime <= last_utime_ && !clock_was_set_back(utime)) {
    return "refused: time stamp is not later than the last frame's";
  }
  past_begin_utime_ = past_utime_ = -1;
  const bool leaps = last_utime_ >= 0 && utime - last_utime_ > options_.max_leap_utime;
  const bool confirmed = leap_utime_ >= 0 && utime > leap_utime_ && utime - leap_utime_ <= options_.max_leap_utime;
  if (leaps && !confirmed) {
    // A single wrong stamp from the future must not shut out every frame after it.
    leap_utime_ = utime;
    return "refused: time stamp leaps far ahead, the next frame has to confirm it";
  }
  leap_utime_ = -1;
  last_utime_ = utime;
  return {};
}

bool Tracker::clock_was_set_back(std::int64_t utime) {
  // Not a few late frames, but a second of them, each later than the one before: their time is the time from now on.
  if (past_begin_utime_ < 0 || utime <= past_utime_) past_begin_utime_ = utime;
  past_utime_ = utime;
  if (utime - past_begin_utime_ < options_.max_past_utime) return false;
  last_utime_ = past_begin_utime_;
  if (map_.empty()) return true;
  // The camera has moved on meanwhile, but not far: the last pose still says where to look.
  motion_.reset(past_begin_utime_, motion_.predict(last_measured_utime_));
  last_measured_utime_ = past_begin_utime_;
  lost_ = true;
  return true;
}

TrackResult Tracker::initialise(const FrameFeatures& features) {
  const auto has_depth = [](const auto& feature) { return feature.has_depth(); };
  const auto points = std::count_if(features.points.begin(), features.points.end(), has_depth);
  if (features.planes.empty() && points < options_.min_points_without_planes) {
    return refuse(features.header, "waiting for a frame with a plane or enough points with depth");
  }
  Frame frame{.features = features, .prediction = known_within(Pose{}, kCertain, kCertain)};
  motion_.reset(features.header.utime, frame.prediction);
  return finish(frame, TrackingState::tracking, "first keyframe");
}

TrackResult Tracker::refuse(const image::FrameHeader& header, std::string reason) const {
  TrackResult result;
  result.estimate.header = header;
  result.estimate.state = state_;  // a frame that is refused changes nothing
  result.estimate.reason = std::move(reason);
  return result;
}

TrackResult Tracker::finish(Frame& frame, TrackingState state, std::string reason) {
  TrackResult result;
  PoseEstimate& estimate = result.estimate;
  estimate.header = frame.features.header;
  estimate.state = state;
  estimate.reason = std::move(reason);
  estimate.has_pose = true;
  estimate.world_from_camera = frame.camera_from_world.inverse();
  estimate.rotation_reference = frame.rotation_reference;
  estimate.matched_points = static_cast<std::int32_t>(frame.matches.points.size());
  estimate.matched_lines = static_cast<std::int32_t>(frame.matches.lines.size());
  estimate.matched_planes = static_cast<std::int32_t>(frame.matches.planes.size());
  estimate.matched_directions = static_cast<std::int32_t>(frame.associations.size());
  if (!map_.empty()) {
    estimate.covariance = world_covariance(frame.solution.information, frame.prediction, estimate.world_from_camera);
    estimate.covariance = with_turns_of_camera(estimate.covariance, estimate.world_from_camera, kMinRotationVariance);
  }
  lost_ = false;
  state_ = state;
  motion_.update(frame.features.header.utime, frame.camera_from_world, frame.solution.information, frame.unseen_turn);
  if (frame.unseen_turn) return result;  // a guess: neither for the map nor for the graph
  last_measured_utime_ = frame.features.header.utime;
  last_found_ = found(frame);

  count_visibility(frame);
  if (map_.empty() || frame.begins_anew ||
      policy_.wants_keyframe(features_of_last_keyframe(frame), sees_new_structure(frame))) {
    add_keyframe(frame, result);
  } else if (const auto views = direction_views(frame)) {
    direction_tracks_.add(*views);
  }
  return result;
}

void Tracker::count_visibility(const Frame& frame) {
  const geometry::CameraModel& camera = frame.features.camera;
  std::vector<PointId> points = visible_points(camera, map_, frame.near_points, frame.camera_from_world);
  std::vector<LineId> lines = visible_lines(camera, map_, frame.near_lines, frame.camera_from_world);
  const auto point_names = index_by_track(frame.features.points);
  const auto line_names = index_by_track(frame.features.lines);
  std::erase_if(points, [&](PointId id) { return is_hidden(map_.point(id), point_names); });
  std::erase_if(lines, [&](LineId id) { return is_hidden(map_.line(id), line_names); });
  map_.count_visibility(points, lines, frame.matches);
}

Matrix6d Tracker::covariance_by_map(const Frame& frame) const {
  const PoseSolution by_map = without_directions(frame.problem, frame.solution);
  const Pose world_from_camera = by_map.camera_from_world.inverse();
  return with_turns_of_camera(world_covariance(by_map.information, frame.prediction, world_from_camera),
                              world_from_camera, kMinRotationVariance);
}

}  // namespace eg::tracking
