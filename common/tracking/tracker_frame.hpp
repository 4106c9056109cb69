#pragma once

#include <optional>
#include <vector>

#include "common/tracking/tracker.hpp"

namespace eg::tracking {

/// Radians and metres: a camera at which a map begins is where it is. Not zero, because covariances are inverted.
inline constexpr double kCertain = 1e-6;

/// Everything known about the frame being tracked; it grows from step to step.
struct Tracker::Frame {
  const features::FrameFeatures& features;
  MotionPrior prediction{};
  geometry::Pose camera_from_world{};
  std::vector<egraph::Association> associations{};
  bool rotation_from_graph = false;
  KeyframeId rotation_reference{};
  std::vector<PointId> near_points{};
  std::vector<LineId> near_lines{};
  Matches matches{};
  PoseProblem problem{};
  PoseSolution solution{};
  KeyframeId known_place{};                      ///< found by its descriptors
  bool begins_anew = false;                      ///< a keyframe, for those before it tell no pose
  std::optional<Eigen::Vector3d> unseen_turn{};  ///< axis, camera frame, about which nothing was measured
};

}  // namespace eg::tracking
