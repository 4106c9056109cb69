#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "common/egraph/graph.hpp"
#include "common/egraph/graph_optimizer.hpp"

namespace eg::egraph {

/// The unknowns of a graph's optimisation and what was measured between them.
class GraphProblem {
 public:
  struct Keyframe {
    KeyframeId id;
    geometry::Pose world_from_camera;
    int column = -1;  ///< of its first unknown; -1: held
  };
  struct Landmark {
    LandmarkId id;
    Eigen::Vector3d direction;
    int column = -1;
  };
  /// A keyframe's view of a landmark, as indices into the lists.
  struct View {
    std::size_t keyframe = 0;
    std::size_t landmark = 0;
    Eigen::Vector3d in_camera;
    Eigen::Matrix3d covariance;
  };
  struct Constraint {
    std::size_t first = 0;
    std::size_t second = 0;
    RelativePose measured;
  };
  /// The normal equations H x = -g of the weighted residuals.
  struct Linearization {
    Eigen::SparseMatrix<double> hessian;  ///< lower triangle
    Eigen::VectorXd gradient;
  };

  explicit GraphProblem(const GraphOptimizerOptions& options) : options_(options) {}

  /// Half the sum of the robust losses.
  [[nodiscard]] double cost() const;
  [[nodiscard]] Linearization linearize() const;

  /// Moves the unknowns to where the damped normal equations say. False if they cannot be solved.
  bool step(const Linearization& linear, double damping);

  /// Unknowns per keyframe: rotation, and position if it is refined.
  [[nodiscard]] int keyframe_unknowns() const { return options_.refine == Refinement::poses ? 6 : 3; }

  std::vector<Keyframe> keyframes;
  std::vector<Landmark> landmarks;
  std::vector<View> views;
  std::vector<Constraint> constraints;
  int unknowns = 0;

 private:
  GraphOptimizerOptions options_;
};

/// The newest keyframes of a graph, what they saw, and the relative poses between them. The first keyframe of the graph
/// is held; if the problem does not reach back to it, so are the older keyframes that relative poses refer to, and
/// those that saw the same landmarks before, whose views take part.
GraphProblem make_problem(const Graph& graph, const GraphOptimizerOptions& options);

}  // namespace eg::egraph
