#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "common/base/result.hpp"
#include "common/egraph/direction_index.hpp"
#include "common/egraph/types.hpp"

namespace eg::egraph {

/// The extensibility graph G = [N_c, N_lm, E] (paper, section 4) as a value: the server's state and the replica of
/// every receiver. It changes by updates only, each of which leads from one version to the next.
///
/// E is implicit. In a building of three directions every keyframe has an edge to every other, so that a list of edges
/// would grow with the square of their number; per landmark the keyframes that saw it are kept instead, from which an
/// edge follows when it is needed. Memory is linear in the number of keyframes, and queries hardly depend on it.
class Graph {
 public:
  /// Refuses an update that does not start at this version (a gap: ask for a snapshot), and one that refers to what
  /// does not exist; the graph is then as before. One already applied is ignored.
  base::Status apply(const GraphUpdate& update);

  /// Takes over a whole graph. Refuses one that refers to what does not exist; the graph is then as before.
  base::Status reset(const GraphSnapshot& snapshot);

  /// Moves keyframes and landmarks that are in the graph: what an optimisation within the current version found.
  /// Receivers get it with the update to that version.
  void refine(std::span<const CorrectedPose> keyframes, std::span<const DirectionLandmark> landmarks);

  [[nodiscard]] GraphSnapshot snapshot(std::int64_t session) const;
  [[nodiscard]] std::int64_t version() const { return version_; }

  /// Ordered by id. Ids are never reused.
  [[nodiscard]] std::span<const DirectionLandmark> landmarks() const { return landmarks_; }
  [[nodiscard]] const DirectionLandmark* find_landmark(LandmarkId id) const;
  [[nodiscard]] LandmarkId next_landmark() const { return next_landmark_; }
  [[nodiscard]] std::span<const KeyframeNode> keyframes() const { return keyframes_; }
  [[nodiscard]] const KeyframeNode* find_keyframe(KeyframeId id) const;

  /// What was measured between keyframe `oldest` or a younger one and any other; by the younger of the two.
  [[nodiscard]] std::span<const RelativePose> relative_poses_from(KeyframeId oldest) const;

  /// Landmarks whose direction or its opposite is within `max_angle` (radians) of `direction`, and perhaps some more;
  /// ordered by id.
  [[nodiscard]] std::vector<const DirectionLandmark*> landmarks_near(const Eigen::Vector3d& direction,
                                                                     double max_angle) const;

  /// Potential directions, ordered by id.
  [[nodiscard]] const std::set<LandmarkId>& potential_directions() const { return potential_directions_; }

  /// The keyframes that observed a landmark, oldest first.
  [[nodiscard]] std::span<const KeyframeId> observers(LandmarkId id) const;

  /// What a keyframe observed.
  [[nodiscard]] std::span<const Observation> observations(KeyframeId id) const;

  /// The keyframes that share two or more non-parallel landmarks of the given set, oldest first: what an edge needs.
  /// If `younger` is valid, only those that are older than it; it becomes the `second` of the edges. Of each landmark
  /// the `max_observers` oldest observers are considered.
  [[nodiscard]] std::vector<Edge> sharing_keyframes(std::span<const LandmarkId> landmarks, KeyframeId younger = {},
                                                    std::size_t max_observers = SIZE_MAX) const;

  /// The oldest keyframe that shares two or more non-parallel landmarks: rotation measured against it has not drifted.
  [[nodiscard]] std::optional<KeyframeId> oldest_sharing_keyframe(std::span<const LandmarkId> landmarks) const;

  /// The edges between keyframe `id` and older ones, oldest first.
  [[nodiscard]] std::vector<Edge> edges_to_older(KeyframeId id, std::size_t max_observers = SIZE_MAX) const;

  /// All edges, by the younger keyframe. Their number grows with the square of the graph's size unless it is bounded.
  [[nodiscard]] std::vector<Edge> edges(std::size_t max_observers = SIZE_MAX) const;

 private:
  [[nodiscard]] base::Status check(const GraphUpdate& update) const;
  void remove_landmark(LandmarkId id);
  void put_landmark(const DirectionLandmark& landmark);
  void put_observation(const Observation& observation);
  void put_relative_pose(const RelativePose& relative);
  /// The tracker has moved a keyframe by what it measured in the map around it: relative poses to and from it are now
  /// what they are between the keyframes.
  void measure_again(KeyframeId moved);
  [[nodiscard]] bool parallel(LandmarkId a, LandmarkId b) const;
  [[nodiscard]] bool spans_a_plane(std::span<const LandmarkId> landmarks) const;

  std::int64_t version_ = 0;
  LandmarkId next_landmark_{0};
  std::vector<KeyframeNode> keyframes_;
  std::vector<DirectionLandmark> landmarks_;
  std::vector<Observation> observations_;     ///< ordered by keyframe
  std::vector<RelativePose> relative_poses_;  ///< ordered by the younger, then the older keyframe
  std::vector<GraphSnapshot::CovisibilityEdge> covisibility_;
  std::map<KeyframeId, std::vector<KeyframeId>> measured_against_;  ///< by the older: younger ones of relative_poses_
  std::map<LandmarkId, std::vector<KeyframeId>> observers_;
  std::set<LandmarkId> potential_directions_;
  DirectionIndex index_;
};

}  // namespace eg::egraph
