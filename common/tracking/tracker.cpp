#include "common/tracking/tracker.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/check.hpp"
#include "common/geometry/so3.hpp"
#include "common/tracking/frame_problem.hpp"
#include "common/tracking/observability.hpp"

namespace eg::tracking {
namespace {

using features::FrameFeatures;
using geometry::Pose;

/// Floor on the rotation uncertainty of a keyframe (0.05°): correlated errors do not average out over features.
constexpr double kMinRotationVariance = 7.6e-7;

template <typename Match>
std::vector<Match> only(const std::vector<Match>& matches, const std::vector<bool>& keep) {
  std::vector<Match> kept;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (keep[i]) kept.push_back(matches[i]);
  }
  return kept;
}

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

struct Tracker::Frame {
  const FrameFeatures& features;
  MotionPrior prediction{};
  Pose camera_from_world{};
  std::vector<egraph::Association> associations{};
  bool rotation_from_graph = false;
  KeyframeId rotation_reference{};
  std::vector<PointId> near_points{};
  std::vector<LineId> near_lines{};
  Matches matches{};
  PoseProblem problem{};
  PoseSolution solution{};
  std::optional<Eigen::Vector3d> unseen_turn{};  ///< axis, camera frame, about which nothing was measured
};

Tracker::Tracker(TrackerOptions options) : options_(options), motion_(options.motion), policy_(options.keyframes) {}

void Tracker::continue_in(Map map, egraph::Graph graph) {
  EG_CHECK(map_.empty() && !map.empty(), "a map is continued before the first frame, and has keyframes");
  map_ = std::move(map);
  graph_ = std::move(graph);
  for (const MapKeyframe& keyframe : map_.keyframes()) {
    const egraph::KeyframeNode* const node = graph_.find_keyframe(keyframe.id);
    EG_CHECK(node != nullptr, "the graph of a map knows its keyframes");
    keyframe_covariances_.push_back(node->covariance);
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
    return refuse(features, std::move(objection));
  }
  if (map_.empty()) return initialise(features);
  const std::int64_t blind = features.header.utime - last_measured_utime_;
  if (lost_ && blind > options_.max_blind_utime) return recover(features, "searching for a known place");

  Frame frame = estimate(features);
  if (points_contradict(frame)) return recover(features, "planes fit here, but none of the expected points");

  const Observability observed = observability(frame.solution.information);
  const bool proven = frame.solution.inlier_points() >= options_.min_points_without_planes ||
                      frame.solution.inlier_planes() > 0 || frame.solution.inlier_lines() >= 4;
  if (proven && observed.translation_sigma < options_.max_translation_sigma) {
    if (lost_) return finish(frame, TrackingState::relocalised, "found near the last pose");
    return finish(frame, TrackingState::tracking, "");
  }
  frame.camera_from_world = keep_predicted_where_unobserved(frame.prediction, frame.camera_from_world,
                                                            frame.solution.information, options_.max_translation_sigma);
  if (observed.rotation_sigma < options_.max_rotation_sigma) {
    return finish(frame, TrackingState::rotation_only, "matches do not determine the translation");
  }
  if (follows_one_wall(frame, observed)) {
    frame.unseen_turn = observed.worst_turn;
    return finish(frame, TrackingState::rotation_only, "a single direction in view: the turn about it is predicted");
  }
  return recover(features, "matches determine neither rotation nor translation");
}

Tracker::Frame Tracker::estimate(const FrameFeatures& features) const {
  Frame frame = estimate(features, options_.parts.egraph);
  if (!frame.rotation_from_graph || !planes_are_unmistakable(frame) || !leads_away(frame)) return frame;
  // Directions of the frame were taken for others of the graph: see where the prediction, which is sharp, leads alone.
  Frame predicted = estimate(features, false);
  return leads_away(predicted) ? std::move(frame) : std::move(predicted);
}

Tracker::Frame Tracker::estimate(const FrameFeatures& features, bool with_graph) const {
  Frame frame{.features = features, .prediction = motion_.predict(features.header.utime)};
  frame.camera_from_world = frame.prediction.camera_from_world;
  if (with_graph) follow_graph_rotation(frame);     // section 3.1 and 4.2
  estimate_translation_with_rotation_fixed(frame);  // section 3.1, equation 1 with R known; section 5
  refine_against_map(frame);                        // section 5, frame-to-map refinement
  return frame;
}

bool Tracker::follows_one_wall(const Frame& frame, const Observability& observed) const {
  return !lost_ && frame.solution.inlier_planes() > 0 && observed.second_rotation_sigma < options_.max_rotation_sigma &&
         motion_.unseen_turn_sigma() < options_.max_unseen_turn;
}

std::string Tracker::time_objection(std::int64_t utime) {
  if (utime <= last_utime_) return "refused: time stamp is not later than the last frame's";
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

TrackResult Tracker::initialise(const FrameFeatures& features) {
  const auto has_depth = [](const auto& feature) { return feature.has_depth(); };
  const auto points = std::count_if(features.points.begin(), features.points.end(), has_depth);
  if (features.planes.empty() && points < options_.min_points_without_planes) {
    return refuse(features, "waiting for a frame with a plane or enough points with depth");
  }
  Frame frame{.features = features, .prediction = {}};
  motion_.reset(features.header.utime, Pose{});
  return finish(frame, TrackingState::tracking, "first keyframe");
}

void Tracker::follow_graph_rotation(Frame& frame) const {
  if (!options_.parts.egraph) return;
  const Pose& predicted = frame.prediction.camera_from_world;
  GraphRotation found = estimate_rotation_from_graph(frame.features, graph_, predicted.rotation,
                                                     frame.prediction.rotation_sigma, options_.rotation);
  frame.rotation_from_graph = found.determined;
  frame.rotation_reference = found.reference;
  frame.associations = std::move(found.associations);
  if (!found.determined) return;
  // The camera turns about its own centre: the predicted position stays.
  frame.camera_from_world = {found.camera_from_world, -(found.camera_from_world * predicted.inverse().translation)};
}

void Tracker::match_and_build_problem(Frame& frame, double radius) const {
  const geometry::CameraModel& camera = frame.features.camera;
  const Pose& pose = frame.camera_from_world;
  MatchOptions search = options_.search;
  search.radius = radius;
  frame.near_points = map_.points_near(camera, pose);
  frame.near_lines = map_.lines_near(camera, pose);
  frame.matches.points = match_points(frame.features, map_, frame.near_points, pose, search);
  frame.matches.lines = match_lines(frame.features, map_, frame.near_lines, pose, search);
  frame.matches.planes = match_planes(frame.features, map_, pose, frame.prediction.translation_sigma, search);
  frame.problem.camera = camera;
  frame.problem.prior = frame.prediction;
  frame.problem.points = point_factors(frame.features, map_, frame.matches.points, pose);
  frame.problem.lines = line_factors(frame.features, map_, frame.matches.lines, pose);
  frame.problem.planes = plane_factors(frame.features, map_, frame.matches.planes, pose);
  frame.problem.directions = direction_factors(frame.features, graph_, frame.associations, pose.rotation);
}

void Tracker::estimate_translation_with_rotation_fixed(Frame& frame) const {
  match_and_build_problem(frame, options_.search.radius);
  const auto consensus = estimate_translation(frame.problem.points, frame.features.camera,
                                              frame.camera_from_world.rotation, options_.translation);
  if (consensus) {
    frame.camera_from_world.translation = consensus->translation;
    frame.matches.points = only(frame.matches.points, consensus->inliers);
    frame.problem.points = point_factors(frame.features, map_, frame.matches.points, frame.camera_from_world);
  }
  const FreeParameters free = frame.rotation_from_graph ? FreeParameters::translation : FreeParameters::pose;
  frame.camera_from_world =
      optimize_pose(frame.problem, frame.camera_from_world, free, options_.optimizer).camera_from_world;
}

void Tracker::refine_against_map(Frame& frame) const {
  match_and_build_problem(frame, options_.refined_search_radius);
  const bool rotation_is_final = frame.rotation_from_graph && !options_.parts.refinement;
  frame.solution =
      optimize_pose(frame.problem, frame.camera_from_world,
                    rotation_is_final ? FreeParameters::translation : FreeParameters::pose, options_.optimizer);
  frame.camera_from_world = frame.solution.camera_from_world;
  keep_inliers(frame);
}

void Tracker::keep_inliers(Frame& frame) const {
  frame.matches.points = only(frame.matches.points, frame.solution.point_inliers);
  frame.matches.lines = only(frame.matches.lines, frame.solution.line_inliers);
  frame.matches.planes = only(frame.matches.planes, frame.solution.plane_inliers);
}

TrackResult Tracker::recover(const FrameFeatures& features, const std::string& why) {
  // The newest keyframe first: most losses are a quick turn. Then the others in turn, a few per frame.
  const auto keyframes = map_.keyframes();
  for (int candidate = 0; candidate < options_.relocalisation_candidates; ++candidate) {
    const std::size_t index = candidate == 0
                                  ? keyframes.size() - 1
                                  : (next_candidate_ + static_cast<std::size_t>(candidate)) % keyframes.size();
    const auto pose = relocalise(features, map_, keyframes[index], options_.relocaliser);
    if (!pose) continue;
    Frame frame{.features = features, .prediction = {*pose, 0.1, 0.1}};
    frame.camera_from_world = *pose;
    follow_graph_rotation(frame);
    frame.camera_from_world = *pose;
    refine_against_map(frame);
    const Observability observed = observability(frame.solution.information);
    if (frame.solution.inlier_points() < options_.relocaliser.min_inliers ||
        observed.translation_sigma > options_.max_translation_sigma) {
      continue;
    }
    motion_.reset(features.header.utime, frame.camera_from_world);
    return finish(frame, TrackingState::relocalised, "found keyframe " + std::to_string(keyframes[index].id.value));
  }
  next_candidate_ += static_cast<std::size_t>(options_.relocalisation_candidates - 1);
  lost_ = true;
  state_ = TrackingState::lost;
  return refuse(features, why);
}

TrackResult Tracker::refuse(const FrameFeatures& features, std::string reason) const {
  TrackResult result;
  result.estimate.header = features.header;
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
    estimate.covariance.topLeftCorner<3, 3>() += kMinRotationVariance * Eigen::Matrix3d::Identity();
  }
  lost_ = false;
  state_ = state;
  motion_.update(frame.features.header.utime, frame.camera_from_world, state != TrackingState::rotation_only,
                 frame.unseen_turn);
  if (frame.unseen_turn) return result;  // a guess: neither for the map nor for the graph
  last_measured_utime_ = frame.features.header.utime;

  map_.count_visibility(visible_points(frame.features.camera, map_, frame.near_points, frame.camera_from_world), {},
                        frame.matches);
  if (map_.empty() || policy_.wants_keyframe(features_of_last_keyframe(frame), sees_new_structure(frame))) {
    add_keyframe(frame, result);
  } else if (const auto views = direction_views(frame)) {
    direction_tracks_.add(*views);
  }
  return result;
}

bool Tracker::planes_are_unmistakable(const Frame& frame) const {
  return !lost_ && 3.0 * frame.prediction.rotation_sigma < options_.search.max_plane_angle &&
         3.0 * frame.prediction.translation_sigma < options_.search.max_plane_distance;
}

bool Tracker::points_contradict(const Frame& frame) const {
  return !planes_are_unmistakable(frame) && misses_expected_points(frame);
}

bool Tracker::misses_expected_points(const Frame& frame) const {
  const auto expected = visible_points(frame.features.camera, map_, frame.near_points, frame.camera_from_world);
  return static_cast<int>(expected.size()) >= options_.min_expected_points &&
         static_cast<int>(frame.features.points.size()) >= options_.min_expected_points &&
         frame.solution.inlier_points() < options_.min_points_without_planes;
}

bool Tracker::leads_away(const Frame& frame) const {
  const bool misses_planes = 2 * frame.solution.inlier_planes() < static_cast<int>(frame.features.planes.size());
  return misses_planes || misses_expected_points(frame);
}

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
  keyframe_covariances_.push_back(estimate.covariance);
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
