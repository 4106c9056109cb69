#include <utility>

#include "common/tracking/frame_problem.hpp"
#include "common/tracking/tracker_frame.hpp"

/// The pose of one frame, step by step (paper, sections 3.1, 4.2 and 5).
namespace eg::tracking {
namespace {

using features::FrameFeatures;
using geometry::Pose;

template <typename Match>
std::vector<Match> only(const std::vector<Match>& matches, const std::vector<bool>& keep) {
  std::vector<Match> kept;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (keep[i]) kept.push_back(matches[i]);
  }
  return kept;
}

}  // namespace

Tracker::Frame Tracker::estimate(const FrameFeatures& features) const {
  Frame frame = estimate(features, options_.parts.egraph);
  if (!frame.rotation_from_graph || !is_doubtful(frame)) return frame;
  // Directions of the frame were taken for others of the graph, or are wrong: see where the prediction leads alone.
  Frame predicted = estimate(features, false);
  return is_doubtful(predicted) ? std::move(frame) : std::move(predicted);
}

Tracker::Frame Tracker::estimate(const FrameFeatures& features, bool with_graph) const {
  Frame frame{.features = features, .prediction = motion_.predict(features.header.utime)};
  frame.camera_from_world = frame.prediction.camera_from_world;
  if (with_graph) follow_graph_rotation(frame);     // section 3.1 and 4.2
  estimate_translation_with_rotation_fixed(frame);  // section 3.1, equation 1 with R known; section 5
  refine_against_map(frame);                        // section 5, frame-to-map refinement
  return frame;
}

void Tracker::follow_graph_rotation(Frame& frame) const {
  if (!options_.parts.egraph) return;
  const Pose& predicted = frame.prediction.camera_from_world;
  GraphRotation found = estimate_rotation_from_graph(frame.features, graph_, predicted.rotation,
                                                     frame.prediction.rotation_sigma(), options_.rotation);
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
  frame.matches.planes = match_planes(frame.features, map_, pose, frame.prediction.translation_sigma(), search);
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

}  // namespace eg::tracking
