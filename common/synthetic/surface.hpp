#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "common/geometry/plane.hpp"
#include "common/synthetic/material.hpp"

namespace eg::synthetic {

/// A flat convex polygon that is seen from its front only. Positions on it are (u, v) in metres:
/// point = origin + u axis_u + v axis_v, and the front is where axis_u × axis_v points.
struct Surface {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();   ///< world, metres
  Eigen::Vector3d axis_u = Eigen::Vector3d::UnitX();  ///< unit, orthogonal to axis_v
  Eigen::Vector3d axis_v = Eigen::Vector3d::UnitY();
  std::vector<Eigen::Vector2d> outline = {};  ///< corners, counter-clockwise in (u, v); at most kMaxCorners
  Material material = {};

  static constexpr std::size_t kMaxCorners = 12;

  [[nodiscard]] Eigen::Vector3d normal() const { return axis_u.cross(axis_v); }
  [[nodiscard]] geometry::Plane plane() const { return {normal(), -normal().dot(origin)}; }
  [[nodiscard]] Eigen::Vector3d point(const Eigen::Vector2d& uv) const {
    return origin + uv.x() * axis_u + uv.y() * axis_v;
  }
  [[nodiscard]] Eigen::Vector2d uv(const Eigen::Vector3d& point_in_world) const {
    const Eigen::Vector3d d = point_in_world - origin;
    return {axis_u.dot(d), axis_v.dot(d)};
  }
  /// Whether `uv` lies within the outline (its border included, `margin` metres beyond it too).
  [[nodiscard]] bool contains(const Eigen::Vector2d& uv, double margin = 0.0) const;
  [[nodiscard]] double area() const;  ///< m²
  /// The largest u and v of the outline, and the smallest.
  [[nodiscard]] Eigen::AlignedBox2d bounds() const;
};

}  // namespace eg::synthetic
