#pragma once

#include <cstddef>
#include <vector>

#include "common/mapping/mesh.hpp"

namespace eg::mapping {

/// Bytes that a vertex (position, normal, colour) and a triangle (three 16-bit indices) take in a message.
inline constexpr std::size_t kVertexBytes = 27;
inline constexpr std::size_t kTriangleBytes = 6;

/// Cuts a mesh into parts of at most `max_bytes` in a message and 65535 vertices, in the order of its triangles.
/// Vertices that parts have in common are repeated. A mesh without triangles is one part without anything.
std::vector<Mesh> split_mesh(const Mesh& mesh, std::size_t max_bytes);

/// Joins meshes that have vertices at the very same places in common, as those of maps that share the space have along
/// the borders of their tiles.
Mesh join_meshes(const std::vector<Mesh>& meshes);

}  // namespace eg::mapping
