#pragma once

#include <deque>
#include <utility>

#include "common/base/result.hpp"
#include "common/egraph/association.hpp"
#include "common/egraph/graph.hpp"
#include "common/egraph/graph_optimizer.hpp"
#include "common/egraph/types.hpp"

namespace eg::egraph {

struct GraphBuilderOptions {
  AssociationOptions association;
  int potential_lifetime = 10;         ///< keyframes after which a potential direction without a partner is removed
  double min_landmark_sigma = 0.0009;  ///< radians (0.05°): real walls and edges are not parallel to better than this
  GraphOptimizerOptions optimizer;
};

/// Updates that are kept to be sent again: a tracker waits for the latest, and who lacks more gets a snapshot.
inline constexpr std::size_t kRecentUpdates = 64;

/// What a keyframe is to a graph.
enum class Arrival {
  next,      ///< the one that the graph waits for
  repeated,  ///< it is in the graph
  early,     ///< its predecessors are not in the graph
  foreign,   ///< the graph holds another keyframe under its id: somebody else uses the session
};

/// What a builder goes on with.
struct BuilderState {
  Graph graph;
  std::deque<GraphUpdate> recent;  ///< the latest updates, at most kRecentUpdates

  /// Applies an update to the graph and remembers it.
  base::Status apply(const GraphUpdate& update);
  /// Takes a whole graph in the place of everything.
  base::Status reset(const GraphSnapshot& snapshot);
  void remember(const GraphUpdate& update);
};

/// The authority on the graph: turns keyframes into updates (paper, section 4.2).
class GraphBuilder {
 public:
  explicit GraphBuilder(GraphBuilderOptions options = {}, BuilderState state = {})
      : options_(options), state_(std::move(state)) {}

  [[nodiscard]] Arrival arrival_of(const Keyframe& keyframe) const;

  /// Initialisation, association, fusion, promotion and removal for one keyframe, applied to graph(), and now and then
  /// an optimisation of the graph. Keyframes come in the order of their ids: one that was added lately gives its first
  /// answer again, any other one is refused.
  base::Result<GraphUpdate> add_keyframe(const Keyframe& keyframe);

  [[nodiscard]] const Graph& graph() const { return state_.graph; }

  /// The latest updates, one after the other: what is sent again when a receiver missed it.
  [[nodiscard]] const std::deque<GraphUpdate>& recent_updates() const { return state_.recent; }

 private:
  void fuse(const Keyframe& keyframe, GraphUpdate& update) const;
  void remove_stale_potentials(const Keyframe& keyframe, GraphUpdate& update) const;
  void optimize(GraphUpdate& update);

  GraphBuilderOptions options_;
  BuilderState state_;
};

/// The covariance-weighted mean of a landmark and a new view of it, both in the world frame.
void fuse_direction(DirectionLandmark& landmark, const Eigen::Vector3d& direction, const Eigen::Matrix3d& covariance,
                    double min_sigma);

}  // namespace eg::egraph
