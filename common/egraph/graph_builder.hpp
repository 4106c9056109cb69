#pragma once

#include <vector>

#include "common/base/result.hpp"
#include "common/egraph/association.hpp"
#include "common/egraph/graph.hpp"
#include "common/egraph/types.hpp"

namespace eg::egraph {

struct GraphBuilderOptions {
  AssociationOptions association;
  int potential_lifetime = 10;         ///< keyframes after which a potential direction without a partner is removed
  double min_landmark_sigma = 0.0009;  ///< radians (0.05°): real walls and edges are not parallel to better than this
};

/// The authority on the graph: turns keyframes into updates (paper, section 4.2).
class GraphBuilder {
 public:
  explicit GraphBuilder(GraphBuilderOptions options = {}) : options_(options) {}

  /// Initialisation, association, fusion, promotion, removal and edges for one keyframe, applied to graph(). Keyframes
  /// come in the order of their ids: one that is already in the graph gives its first answer again, one that is too
  /// early is refused.
  base::Result<GraphUpdate> add_keyframe(const Keyframe& keyframe);

  [[nodiscard]] const Graph& graph() const { return graph_; }

 private:
  void fuse(const Keyframe& keyframe, GraphUpdate& update);
  void remove_stale_potentials(const Keyframe& keyframe, GraphUpdate& update) const;
  void connect(GraphUpdate& update) const;

  GraphBuilderOptions options_;
  Graph graph_;
  std::vector<GraphUpdate> history_;  ///< one per keyframe: what is sent again when a receiver missed it
  std::int32_t next_landmark_ = 0;
};

/// The covariance-weighted mean of a landmark and a new view of it, both in the world frame.
void fuse_direction(DirectionLandmark& landmark, const Eigen::Vector3d& direction, const Eigen::Matrix3d& covariance,
                    double min_sigma);

}  // namespace eg::egraph
