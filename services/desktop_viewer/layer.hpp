#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/pose.hpp"
#include "common/io/ply.hpp"

namespace eg::services {

/// One thing to see that can be switched on and off. What is drawn of the shape: its triangles, else its edges, else
/// its vertices as points; every vertex has a colour.
struct Layer {
  std::string name;       ///< for people and as a key
  std::string part = {};  ///< which part of the layer: parts come one by one, and are switched together
  io::PlyData shape{};    ///< display frame (display_from_world), metres
  float width = 1.0F;     ///< of lines and points, pixels
  bool visible = true;    ///< at first
  bool in_view = true;    ///< the first view shows all of it; false for what has outliers
};

inline constexpr mapping::Colour kTrajectoryColour = {110, 168, 254};
inline constexpr mapping::Colour kTruthColour = {255, 216, 77};
inline constexpr mapping::Colour kKeyframeColour = {195, 208, 224};
inline constexpr mapping::Colour kEdgeColour = {61, 220, 151};

/// Axes for the eye: x to the first camera's right, y ahead of it, z along `up` (unit, world frame, not along the
/// camera's view). A world that a negative fy has mirrored (docs/frames.md) is mirrored back: the determinant is -1.
Eigen::Matrix3f display_from_world(const Eigen::Vector3d& up, bool mirrored);

/// Positions into the display frame; triangles keep their outside outside.
void to_display(const Eigen::Matrix3f& display_from_world, io::PlyData& shape);

/// A line through the positions of the poses, world frame.
io::PlyData path_shape(std::span<const geometry::StampedPose> poses, const mapping::Colour& colour);

/// A view pyramid of 10 cm for each pose, world frame.
io::PlyData camera_shape(std::span<const geometry::StampedPose> poses, const mapping::Colour& colour);

}  // namespace eg::services
