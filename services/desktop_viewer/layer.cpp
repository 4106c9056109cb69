#include "services/desktop_viewer/layer.hpp"

#include <Eigen/Geometry>
#include <array>
#include <utility>

namespace eg::services {
namespace {

/// Corners of the picture at 10 cm, with the aspect and about the field of view of common RGB-D cameras (60 degrees).
const std::array<Eigen::Vector3d, 4> kPyramid = {{
    {-0.057, -0.043, 0.1},
    {0.057, -0.043, 0.1},
    {0.057, 0.043, 0.1},
    {-0.057, 0.043, 0.1},
}};

}  // namespace

Eigen::Matrix3f display_from_world(const Eigen::Vector3d& up, bool mirrored) {
  const Eigen::Vector3d z = up.normalized();
  const Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d y = (ahead - ahead.dot(z) * z).normalized();
  const Eigen::Vector3d x = (mirrored ? -1.0 : 1.0) * y.cross(z);
  Eigen::Matrix3d rotation;
  rotation << x.transpose(), y.transpose(), z.transpose();
  return rotation.cast<float>();
}

void to_display(const Eigen::Matrix3f& display_from_world, io::PlyData& shape) {
  for (Eigen::Vector3f& vertex : shape.vertices) vertex = (display_from_world * vertex).eval();
  for (Eigen::Vector3f& normal : shape.normals) normal = (display_from_world * normal).eval();
  if (display_from_world.determinant() > 0.0F) return;
  for (auto& triangle : shape.triangles) std::swap(triangle[1], triangle[2]);
}

io::PlyData path_shape(std::span<const geometry::StampedPose> poses, const mapping::Colour& colour) {
  io::PlyData shape;
  for (const geometry::StampedPose& pose : poses) {
    const auto index = static_cast<std::uint32_t>(shape.vertices.size());
    shape.vertices.push_back(pose.world_from_camera.translation.cast<float>());
    if (index > 0) shape.edges.push_back({index - 1, index});
  }
  shape.colours.assign(shape.vertices.size(), colour);
  return shape;
}

io::PlyData camera_shape(std::span<const geometry::StampedPose> poses, const mapping::Colour& colour) {
  io::PlyData shape;
  for (const geometry::StampedPose& pose : poses) {
    const auto centre = static_cast<std::uint32_t>(shape.vertices.size());
    shape.vertices.push_back(pose.world_from_camera.translation.cast<float>());
    for (std::uint32_t corner = 0; corner < kPyramid.size(); ++corner) {
      shape.vertices.push_back((pose.world_from_camera * kPyramid[corner]).cast<float>());
      shape.edges.push_back({centre, centre + 1 + corner});
      shape.edges.push_back({centre + 1 + corner, centre + 1 + (corner + 1) % 4});
    }
  }
  shape.colours.assign(shape.vertices.size(), colour);
  return shape;
}

}  // namespace eg::services
