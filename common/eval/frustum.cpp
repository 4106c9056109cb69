#include "common/eval/frustum.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace eg::eval {

Frustum::Frustum(const geometry::CameraModel& camera, const geometry::Pose& world_from_camera, double nearest,
                 double farthest) {
  const double right = camera.width - 1, bottom = camera.height - 1;
  const std::array<Eigen::Vector2d, 4> pixels = {Eigen::Vector2d{0, 0}, {right, 0}, {right, bottom}, {0, bottom}};
  for (std::size_t i = 0; i < 4; ++i) {
    corners_[i] = world_from_camera * camera.unproject(pixels[i], nearest);
    corners_[i + 4] = world_from_camera * camera.unproject(pixels[i], farthest);
    edge_directions_[i] = world_from_camera.rotation * camera.ray(pixels[i]);
  }
  edge_directions_[4] = world_from_camera.rotation.col(0);
  edge_directions_[5] = world_from_camera.rotation.col(1);
  for (std::size_t i = 0; i < 4; ++i) face_normals_[i] = edge_directions_[i].cross(edge_directions_[(i + 1) % 4]);
  face_normals_[4] = world_from_camera.rotation.col(2);
}

bool Frustum::separated_along(const Eigen::Vector3d& axis, const Frustum& other) const {
  const auto interval = [&](const Frustum& frustum) {
    double low = axis.dot(frustum.corners_[0]), high = low;
    for (const Eigen::Vector3d& corner : frustum.corners_) {
      low = std::min(low, axis.dot(corner));
      high = std::max(high, axis.dot(corner));
    }
    return std::pair(low, high);
  };
  const auto [low, high] = interval(*this);
  const auto [other_low, other_high] = interval(other);
  return high < other_low || other_high < low;
}

bool Frustum::intersects(const Frustum& other) const {
  for (const Frustum* owner : {this, &other}) {
    for (const Eigen::Vector3d& normal : owner->face_normals_) {
      if (separated_along(normal, other)) return false;
    }
  }
  for (const Eigen::Vector3d& a : edge_directions_) {
    for (const Eigen::Vector3d& b : other.edge_directions_) {
      if (separated_along(a.cross(b), other)) return false;
    }
  }
  return true;
}

}  // namespace eg::eval
