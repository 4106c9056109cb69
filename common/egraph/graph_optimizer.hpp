#pragma once

#include <optional>
#include <vector>

#include "common/egraph/graph.hpp"
#include "common/egraph/types.hpp"

namespace eg::egraph {

/// What of the graph is refined.
enum class Refinement {
  none,       ///< nothing: the ablation
  rotations,  ///< rotation averaging: landmark directions and keyframe rotations
  poses,      ///< the joint pose graph: positions too, over covisibility and extensibility edges together
};

struct GraphOptimizerOptions {
  Refinement refine = Refinement::poses;
  int max_iterations = 10;
  int max_keyframes = 1000;             ///< the newest ones: bounds the work; older ones are held
  double min_direction_sigma = 0.0009;  ///< radians (0.05°): real walls and edges are not parallel to better than this
  double direction_chi2 = 5.99;         ///< 95 % of chi²(2): beyond, a direction loses weight (Cauchy's robust loss)
  double rotation_chi2 = 7.81;          ///< 95 % of chi²(3), likewise for relative rotations
  double pose_chi2 = 12.59;             ///< 95 % of chi²(6), likewise for relative poses
  double min_rotation_step = 1e-5;      ///< radians (0.0006°): who moved less is not in the result
  double min_translation_step = 1e-5;   ///< metres
};

/// What the optimisation has moved.
struct GraphCorrections {
  std::vector<CorrectedPose> keyframes;
  std::vector<DirectionLandmark> landmarks;  ///< whole
  double initial_cost = 0.0;                 ///< half the sum of the robust losses
  double final_cost = 0.0;
  int iterations = 0;
};

/// Makes keyframes and landmarks agree with all that was measured between them: landmark directions seen by keyframes
/// (extensibility, which needs no overlap) and relative poses (covisibility), weighted by their covariances under a
/// robust loss. Levenberg-Marquardt on SO(3) x R³ per keyframe and S² per landmark with sparse Cholesky factorisation.
/// The first keyframe is the gauge and stays. Deterministic.
GraphCorrections optimize_graph(const Graph& graph, const GraphOptimizerOptions& options = {});

/// Whether the graph is to be optimised when it has `keyframes`: every 8 at first, later at every tenth to twentieth of
/// its size, at most every 128. So the work per keyframe does not grow with the graph.
bool optimization_is_due(std::size_t keyframes);

}  // namespace eg::egraph
