#pragma once

#include <Eigen/Core>

#include "common/geometry/pose.hpp"

namespace eg::geometry {

/// The plane {x : normal · x + distance = 0} in Hessian form; unit normal, distance in metres. Seen from the camera at
/// the origin, a normal towards the camera means distance > 0.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double distance = 0.0;

  [[nodiscard]] double signed_distance(const Eigen::Vector3d& point) const { return normal.dot(point) + distance; }
};

/// The same plane in frame b.
inline Plane transform(const Pose& b_from_a, const Plane& plane_in_a) {
  const Eigen::Vector3d normal = b_from_a.rotation * plane_in_a.normal;
  return {normal, plane_in_a.distance - normal.dot(b_from_a.translation)};
}

}  // namespace eg::geometry
