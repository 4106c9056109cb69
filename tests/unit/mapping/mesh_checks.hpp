#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>

#include "common/mapping/mesh.hpp"

namespace eg::mapping {

/// How the edges of a mesh are used.
struct EdgeReport {
  int edges = 0;
  int open = 0;      ///< with one triangle
  int overused = 0;  ///< with more than two, or with two that run along it the same way
};

inline EdgeReport check_edges(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<int, 2>> uses;  // per direction
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangle[i];
      const std::uint32_t b = triangle[(i + 1) % 3];
      ++uses[std::minmax(a, b)][a < b ? 0 : 1];
    }
  }
  EdgeReport report;
  for (const auto& [edge, directions] : uses) {
    ++report.edges;
    report.open += directions[0] + directions[1] == 1;
    report.overused += directions[0] > 1 || directions[1] > 1;
  }
  return report;
}

/// V - E + F: 2 for a closed surface without handles.
inline int euler_characteristic(const Mesh& mesh) {
  return static_cast<int>(mesh.vertices.size()) - check_edges(mesh).edges + static_cast<int>(mesh.triangles.size());
}

inline Eigen::Vector3f area_vector(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const Eigen::Vector3f& a = mesh.vertices[triangle[0]];
  return 0.5F * (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a);
}

inline float smallest_area(const Mesh& mesh) {
  float smallest = 1e9F;
  for (const auto& triangle : mesh.triangles) smallest = std::min(smallest, area_vector(mesh, triangle).norm());
  return smallest;
}

/// Share of the triangles that are turned the way the normals of their corners are.
inline double share_facing_their_normals(const Mesh& mesh) {
  int facing = 0;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3f normal = mesh.normals[triangle[0]] + mesh.normals[triangle[1]] + mesh.normals[triangle[2]];
    facing += area_vector(mesh, triangle).dot(normal) > 0.0F;
  }
  return facing / static_cast<double>(mesh.triangles.size());
}

struct SurfaceError {
  double mean = 0.0;  ///< metres
  double max = 0.0;
};

/// Of the vertices, by a function that gives a point's distance from the true surface.
template <typename Distance>
SurfaceError surface_error(const Mesh& mesh, const Distance& distance) {
  SurfaceError error;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    const double d = distance(vertex.cast<double>());
    error.mean += d / static_cast<double>(mesh.vertices.size());
    error.max = std::max(error.max, d);
  }
  return error;
}

inline bool is_same(const Mesh& a, const Mesh& b) {
  return a.vertices == b.vertices && a.normals == b.normals && a.colours == b.colours && a.triangles == b.triangles;
}

}  // namespace eg::mapping
