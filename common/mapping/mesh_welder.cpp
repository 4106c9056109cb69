#include "common/mapping/mesh_welder.hpp"

#include <limits>
#include <utility>
#include <vector>

namespace eg::mapping {
namespace {

constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

}  // namespace

void MeshWelder::begin_layer(int x) {
  if (x == layer_) return;
  before_ = x == layer_ + 1 ? std::move(here_) : VertexOfEdge();
  here_ = {};
  layer_ = x;
}

std::uint32_t MeshWelder::find(std::uint64_t key) const {
  if (const auto vertex = here_.find(key); vertex != here_.end()) return vertex->second;
  const auto vertex = before_.find(key);
  return vertex != before_.end() ? vertex->second : kNoVertex;
}

Mesh MeshWelder::add(const Eigen::Vector3i& tile, TileMesh mesh) {
  begin_layer(tile.x());
  std::vector<std::uint32_t> joined_from_tile(mesh.mesh.vertices.size(), kNoVertex);
  for (const auto& [key, vertex] : mesh.border) joined_from_tile[vertex] = find(key);
  Mesh piece;
  for (std::size_t i = 0; i < joined_from_tile.size(); ++i) {
    if (joined_from_tile[i] != kNoVertex) continue;
    joined_from_tile[i] = vertices_++;
    piece.vertices.push_back(mesh.mesh.vertices[i]);
    piece.normals.push_back(mesh.mesh.normals[i]);
    piece.colours.push_back(mesh.mesh.colours[i]);
  }
  for (const auto& [key, vertex] : mesh.border) here_.emplace(key, joined_from_tile[vertex]);
  piece.triangles = std::move(mesh.mesh.triangles);
  for (auto& triangle : piece.triangles) {
    for (std::uint32_t& corner : triangle) corner = joined_from_tile[corner];
  }
  return piece;
}

}  // namespace eg::mapping
