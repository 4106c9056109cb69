#include <bit>

#include "common/base/check.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/ply.hpp"

namespace eg::io {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY files are written as the machine stores numbers");

template <typename T>
void append(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

std::string header_of(const PlyView& data) {
  std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(data.vertices.size()) +
                       "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!data.normals.empty()) header += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!data.colours.empty()) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (!data.triangles.empty()) {
    header += "element face " + std::to_string(data.triangles.size()) + "\nproperty list uchar int vertex_indices\n";
  }
  if (!data.edges.empty()) {
    header += "element edge " + std::to_string(data.edges.size()) + "\nproperty int vertex1\nproperty int vertex2\n";
  }
  return header + "end_header\n";
}

}  // namespace

PlyView view_of(const PlyData& data) { return {data.vertices, data.normals, data.colours, data.triangles, data.edges}; }

PlyView view_of(const mapping::Mesh& mesh) { return {mesh.vertices, mesh.normals, mesh.colours, mesh.triangles, {}}; }

std::string format_ply(const PlyView& data) {
  const std::size_t count = data.vertices.size();
  EG_CHECK(data.normals.empty() || data.normals.size() == count, "a mesh has one normal per vertex or none");
  EG_CHECK(data.colours.empty() || data.colours.size() == count, "a mesh has one colour per vertex or none");
  constexpr std::size_t kVertexSize = 27, kTriangleSize = 13, kEdgeSize = 8;
  std::string bytes = header_of(data);
  bytes.reserve(bytes.size() + kVertexSize * count + kTriangleSize * data.triangles.size() +
                kEdgeSize * data.edges.size());
  for (std::size_t i = 0; i < count; ++i) {
    append(bytes, data.vertices[i].data(), 3);
    if (!data.normals.empty()) append(bytes, data.normals[i].data(), 3);
    if (!data.colours.empty()) append(bytes, data.colours[i].data(), 3);
  }
  for (const auto& triangle : data.triangles) {
    bytes += '\3';
    append(bytes, triangle.data(), triangle.size());
  }
  for (const auto& edge : data.edges) append(bytes, edge.data(), edge.size());
  return bytes;
}

base::Status write_ply(const std::filesystem::path& path, const PlyView& data) {
  return write_file_atomically(path, format_ply(data));
}

}  // namespace eg::io
