#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "common/base/result.hpp"
#include "common/egraph/types.hpp"

namespace eg::egraph {

/// The extensibility graph G = [N_c, N_lm, E] (paper, section 4) as a value: the server's state and the replica of
/// every receiver. It changes by updates only, each of which leads from one version to the next.
class Graph {
 public:
  /// Refuses an update that does not start at this version (a gap: ask for a snapshot), and one that refers to what
  /// does not exist; the graph is then as before. One already applied is ignored.
  base::Status apply(const GraphUpdate& update);

  /// Takes over a whole graph. Refuses one that refers to what does not exist; the graph is then as before.
  base::Status reset(const GraphSnapshot& snapshot);

  [[nodiscard]] GraphSnapshot snapshot(std::int64_t session) const;
  [[nodiscard]] std::int64_t version() const { return version_; }

  /// Ordered by id. Ids are never reused.
  [[nodiscard]] std::span<const DirectionLandmark> landmarks() const { return landmarks_; }
  [[nodiscard]] const DirectionLandmark* find_landmark(LandmarkId id) const;
  [[nodiscard]] std::span<const KeyframeNode> keyframes() const { return keyframes_; }
  [[nodiscard]] const KeyframeNode* find_keyframe(KeyframeId id) const;
  [[nodiscard]] std::span<const Edge> edges() const { return edges_; }

  /// The keyframes that observed a landmark, oldest first.
  [[nodiscard]] std::span<const KeyframeId> observers(LandmarkId id) const;

  /// The keyframes that share two or more non-parallel landmarks of the given set, oldest first: what an edge needs.
  [[nodiscard]] std::vector<Edge> sharing_keyframes(std::span<const LandmarkId> landmarks) const;

  /// The oldest keyframe that shares two or more non-parallel landmarks: rotation measured against it has not drifted.
  [[nodiscard]] std::optional<KeyframeId> oldest_sharing_keyframe(std::span<const LandmarkId> landmarks) const;

 private:
  void remove_landmark(LandmarkId id);
  void put_landmark(const DirectionLandmark& landmark);
  void put_observation(const Observation& observation);
  [[nodiscard]] bool spans_a_plane(std::span<const LandmarkId> landmarks) const;

  std::int64_t version_ = 0;
  std::vector<KeyframeNode> keyframes_;
  std::vector<DirectionLandmark> landmarks_;
  std::vector<Observation> observations_;
  std::vector<Edge> edges_;
  std::vector<GraphSnapshot::CovisibilityEdge> covisibility_;
  std::map<LandmarkId, std::vector<KeyframeId>> observers_;
};

}  // namespace eg::egraph
