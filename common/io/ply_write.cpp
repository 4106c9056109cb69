#include <bit>

#include "common/base/check.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/ply_format.hpp"

namespace eg::io {

static_assert(std::endian::native == std::endian::little, "PLY files are written as the machine stores numbers");

PlyCounts counts_of(const PlyView& data) {
  return {data.vertices.size(), !data.normals.empty(), !data.colours.empty(), data.triangles.size(), data.edges.size()};
}

std::string ply_header(const PlyCounts& counts) {
  std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(counts.vertices) +
                       "\nproperty float x\nproperty float y\nproperty float z\n";
  if (counts.normals) header += "property float nx\nproperty float ny\nproperty float nz\n";
  if (counts.colours) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (counts.triangles > 0) {
    header += "element face " + std::to_string(counts.triangles) + "\nproperty list uchar int vertex_indices\n";
  }
  if (counts.edges > 0) {
    header += "element edge " + std::to_string(counts.edges) + "\nproperty int vertex1\nproperty int vertex2\n";
  }
  return header + "end_header\n";
}

void append_ply_vertices(const PlyView& data, std::string& bytes) {
  const std::size_t count = data.vertices.size();
  EG_CHECK(data.normals.empty() || data.normals.size() == count, "a mesh has one normal per vertex or none");
  EG_CHECK(data.colours.empty() || data.colours.size() == count, "a mesh has one colour per vertex or none");
  constexpr std::size_t kVertexSize = 27;
  bytes.reserve(bytes.size() + kVertexSize * count);
  for (std::size_t i = 0; i < count; ++i) {
    append_numbers(data.vertices[i].data(), 3, bytes);
    if (!data.normals.empty()) append_numbers(data.normals[i].data(), 3, bytes);
    if (!data.colours.empty()) append_numbers(data.colours[i].data(), 3, bytes);
  }
}

void append_ply_triangles(const PlyView& data, std::string& bytes) {
  constexpr std::size_t kTriangleSize = 13;
  bytes.reserve(bytes.size() + kTriangleSize * data.triangles.size());
  for (const auto& triangle : data.triangles) {
    bytes += '\3';
    append_numbers(triangle.data(), triangle.size(), bytes);
  }
}

PlyView view_of(const PlyData& data) { return {data.vertices, data.normals, data.colours, data.triangles, data.edges}; }

PlyView view_of(const mapping::Mesh& mesh) { return {mesh.vertices, mesh.normals, mesh.colours, mesh.triangles, {}}; }

std::string format_ply(const PlyView& data) {
  std::string bytes = ply_header(counts_of(data));
  append_ply_vertices(data, bytes);
  append_ply_triangles(data, bytes);
  for (const auto& edge : data.edges) append_numbers(edge.data(), edge.size(), bytes);
  return bytes;
}

base::Status write_ply(const std::filesystem::path& path, const PlyView& data) {
  return write_file_atomically(path, format_ply(data));
}

}  // namespace eg::io
