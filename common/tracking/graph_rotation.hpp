#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/egraph/association.hpp"
#include "common/egraph/graph.hpp"
#include "common/egraph/rotation_solver.hpp"
#include "common/features/features.hpp"

namespace eg::tracking {

/// Where the camera looks, measured against the directions of the E-Graph (paper, section 3.1 and 4.2).
struct GraphRotation {
  bool determined = false;  ///< all three degrees of freedom
  Eigen::Matrix3d camera_from_world = Eigen::Matrix3d::Identity();
  /// The frame's directions and their landmarks. Where the rotation is determined they agree with it.
  std::vector<egraph::Association> associations;
  egraph::KeyframeId reference;  ///< the oldest keyframe that shares two or more of the directions
};

struct GraphRotationOptions {
  egraph::AssociationOptions association{.max_angle = 0.14, .max_chi2 = 13.82};  ///< 8°: prediction error included
  egraph::RotationOptions consensus;
};

/// Associates with the predicted rotation (`rotation_sigma`: radians) and solves: the consensus chooses among all
/// landmarks that the prediction allows for a direction. Planes and vanishing directions
/// decide; single lines join where those do not suffice, and are associated with the result elsewhere.
GraphRotation estimate_rotation_from_graph(const features::FrameFeatures& features, const egraph::Graph& graph,
                                           const Eigen::Matrix3d& predicted_camera_from_world, double rotation_sigma,
                                           const GraphRotationOptions& options = {});

}  // namespace eg::tracking
