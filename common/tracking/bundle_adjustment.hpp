#pragma once

#include <utility>
#include <vector>

#include "common/egraph/graph.hpp"
#include "common/tracking/local_window.hpp"

namespace eg::tracking {

struct BundleOptions {
  int window = 8;                   ///< keyframes that may move
  int iterations = 4;               ///< of Levenberg-Marquardt
  double rotation_sigma = 0.0175;   ///< radians (1°): how far tracking may have turned a keyframe wrongly
  double translation_sigma = 0.05;  ///< metres: how far it may have put it wrongly
};

/// New values for a window of the map.
struct BundleSolution {
  double initial_cost = 0.0;  ///< half the sum of squared, robustly weighted residuals
  double final_cost = 0.0;
  std::vector<std::pair<KeyframeId, geometry::Pose>> world_from_camera;
  std::vector<std::pair<PointId, Eigen::Vector3d>> points;
  std::vector<std::pair<LineId, std::array<Eigen::Vector3d, 2>>> lines;
  std::vector<std::pair<PlaneId, geometry::Plane>> planes;
};

/// Local bundle adjustment (paper, section 5): poses of the window's keyframes with the points, lines and planes that
/// they see. The directions of the E-Graph hold the rotations; keyframes outside the window hold the landmarks. Nothing
/// moves if the cost cannot be lowered. The answer depends on the arguments only: one thread, fixed order.
BundleSolution adjust_bundle(const Map& map, const egraph::Graph& graph, const LocalWindow& window,
                             const BundleOptions& options = {});

/// Gives the map its new values. What only one keyframe has seen moves with that keyframe.
void apply(const BundleSolution& solution, Map& map);

}  // namespace eg::tracking
