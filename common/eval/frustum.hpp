#pragma once

#include <Eigen/Core>
#include <array>

#include "common/geometry/camera_model.hpp"
#include "common/geometry/pose.hpp"

namespace eg::eval {

/// The part of space that a depth camera can measure: a pyramid without its tip, between two distances along the
/// optical axis.
class Frustum {
 public:
  /// Distances in metres, 0 < nearest < farthest.
  Frustum(const geometry::CameraModel& camera, const geometry::Pose& world_from_camera, double nearest,
          double farthest);

  /// Whether two frusta have a point in common: exact, by the separating axis theorem for convex polytopes (Gottschalk,
  /// Lin, Manocha, SIGGRAPH 1996).
  [[nodiscard]] bool intersects(const Frustum& other) const;

 private:
  [[nodiscard]] bool separated_along(const Eigen::Vector3d& axis, const Frustum& other) const;

  std::array<Eigen::Vector3d, 8> corners_;  ///< four near, four far, in the same order around
  std::array<Eigen::Vector3d, 5> face_normals_;
  std::array<Eigen::Vector3d, 6> edge_directions_;
};

}  // namespace eg::eval
