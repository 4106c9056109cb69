#include "common/mapping/mesh_parts.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <map>

#include "common/base/check.hpp"

namespace eg::mapping {
namespace {

constexpr std::size_t kMaxVertices = std::numeric_limits<std::uint16_t>::max();
constexpr std::size_t kNoPart = std::numeric_limits<std::size_t>::max();

std::size_t message_bytes(const Mesh& mesh) {
  return kVertexBytes * mesh.vertices.size() + kTriangleBytes * mesh.triangles.size();
}

}  // namespace

std::vector<Mesh> split_mesh(const Mesh& mesh, std::size_t max_bytes) {
  const std::size_t triangle_at_most = 3 * kVertexBytes + kTriangleBytes;
  EG_CHECK(max_bytes >= triangle_at_most, "a part holds at least one triangle");
  std::vector<Mesh> parts(1);
  std::vector<std::size_t> part_of_vertex(mesh.vertices.size(), kNoPart);
  std::vector<std::uint32_t> number_in_part(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    if (message_bytes(parts.back()) + triangle_at_most > max_bytes || parts.back().vertices.size() + 3 > kMaxVertices) {
      parts.emplace_back();
    }
    Mesh& part = parts.back();
    auto& corners = part.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t vertex = triangle[i];
      if (part_of_vertex[vertex] != parts.size() - 1) {
        part_of_vertex[vertex] = parts.size() - 1;
        number_in_part[vertex] = static_cast<std::uint32_t>(part.vertices.size());
        part.vertices.push_back(mesh.vertices[vertex]);
        part.normals.push_back(mesh.normals[vertex]);
        part.colours.push_back(mesh.colours[vertex]);
      }
      corners[i] = number_in_part[vertex];
    }
  }
  return parts;
}

Mesh join_meshes(const std::vector<Mesh>& meshes) {
  Mesh joined;
  std::map<std::array<float, 3>, std::uint32_t> vertex_at;
  for (const Mesh& mesh : meshes) {
    std::vector<std::uint32_t> joined_from_mesh;
    joined_from_mesh.reserve(mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      const Eigen::Vector3f& at = mesh.vertices[i];
      const auto [vertex, is_new] =
          vertex_at.try_emplace({at.x(), at.y(), at.z()}, static_cast<std::uint32_t>(joined.vertices.size()));
      joined_from_mesh.push_back(vertex->second);
      if (!is_new) continue;
      joined.vertices.push_back(at);
      joined.normals.push_back(mesh.normals[i]);
      joined.colours.push_back(mesh.colours[i]);
    }
    for (const auto& [a, b, c] : mesh.triangles) {
      joined.triangles.push_back({joined_from_mesh[a], joined_from_mesh[b], joined_from_mesh[c]});
    }
  }
  return joined;
}

}  // namespace eg::mapping
