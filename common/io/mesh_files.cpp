#include "common/io/mesh_files.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <ostream>
#include <string_view>
#include <utility>

#include "common/io/atomic_file.hpp"
#include "common/io/ply_format.hpp"

namespace eg::io {
namespace {

constexpr std::size_t kVertexBytes = 27;  // position, normal and colour in a PLY file
constexpr std::size_t kVerticesAtOnce = 4096;

base::Status failed(const std::filesystem::path& stem) {
  return base::fail(stem.string() + ".ply: cannot be written: " + std::strerror(errno));
}

/// Calls `take` with all that a file holds, block by block of `block_bytes`.
base::Status read_all(std::FILE* file, std::size_t block_bytes, const std::function<void(std::string_view)>& take) {
  std::rewind(file);
  std::string block(block_bytes, '\0');
  while (const std::size_t size = std::fread(block.data(), 1, block.size(), file)) take({block.data(), size});
  return std::ferror(file) == 0 ? base::Status() : base::fail("what was written of it cannot be read again");
}

mapping::Mesh parse_vertices(std::string_view rows) {
  const std::size_t count = rows.size() / kVertexBytes;
  mapping::Mesh mesh;
  mesh.vertices.resize(count);
  mesh.normals.resize(count);
  mesh.colours.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const char* const row = rows.data() + kVertexBytes * i;
    std::memcpy(mesh.vertices[i].data(), row, sizeof(Eigen::Vector3f));
    std::memcpy(mesh.normals[i].data(), row + sizeof(Eigen::Vector3f), sizeof(Eigen::Vector3f));
    std::memcpy(mesh.colours[i].data(), row + 2 * sizeof(Eigen::Vector3f), sizeof(mapping::Colour));
  }
  return mesh;
}

}  // namespace

MeshFiles::MeshFiles(std::filesystem::path stem, File vertices, File triangles)
    : stem_(std::move(stem)), vertices_(std::move(vertices)), triangles_(std::move(triangles)) {}

base::Result<MeshFiles::File> MeshFiles::nameless_file(const std::filesystem::path& stem) {
  std::string name = stem.string() + ".partial-XXXXXX";
  const int descriptor = ::mkstemp(name.data());
  if (descriptor < 0) return tl::make_unexpected(failed(stem).error());
  ::unlink(name.c_str());
  File file(::fdopen(descriptor, "w+b"));
  if (file == nullptr) {
    ::close(descriptor);
    return tl::make_unexpected(failed(stem).error());
  }
  return file;
}

base::Result<MeshFiles> MeshFiles::create(const std::filesystem::path& stem) {
  auto vertices = nameless_file(stem);
  if (!vertices) return tl::make_unexpected(vertices.error());
  auto triangles = nameless_file(stem);
  if (!triangles) return tl::make_unexpected(triangles.error());
  return MeshFiles(stem, *std::move(vertices), *std::move(triangles));
}

base::Status MeshFiles::add(const mapping::Mesh& piece) {
  std::string rows;
  append_ply_vertices(view_of(piece), rows);
  std::string triangles;
  append_ply_triangles(view_of(piece), triangles);
  if (std::fwrite(rows.data(), 1, rows.size(), vertices_.get()) != rows.size() ||
      std::fwrite(triangles.data(), 1, triangles.size(), triangles_.get()) != triangles.size()) {
    return failed(stem_);
  }
  vertex_count_ += piece.vertices.size();
  triangle_count_ += piece.triangles.size();
  return {};
}

base::Status MeshFiles::finish() {
  if (std::fflush(vertices_.get()) != 0 || std::fflush(triangles_.get()) != 0) return failed(stem_);
  const base::Status ply = write_ply_file();
  return ply ? write_pcd_file() : ply;
}

base::Status MeshFiles::write_ply_file() const {
  return write_file_atomically(stem_.string() + ".ply", [this](std::ostream& out) -> base::Status {
    const bool has_vertices = vertex_count_ > 0;
    out << ply_header({vertex_count_, has_vertices, has_vertices, triangle_count_, 0});
    for (std::FILE* file : {vertices_.get(), triangles_.get()}) {
      const auto copied = read_all(file, kVertexBytes * kVerticesAtOnce, [&](std::string_view bytes) { out << bytes; });
      if (!copied) return copied;
    }
    return {};
  });
}

base::Status MeshFiles::write_pcd_file() const {
  return write_file_atomically(stem_.string() + ".pcd", [this](std::ostream& out) -> base::Status {
    const bool has_vertices = vertex_count_ > 0;
    out << pcd_header({vertex_count_, has_vertices, has_vertices, 0, 0});
    return read_all(vertices_.get(), kVertexBytes * kVerticesAtOnce, [&](std::string_view rows) {
      const mapping::Mesh vertices = parse_vertices(rows);
      std::string points;
      append_pcd_points(view_of(vertices), points);
      out << points;
    });
  });
}

}  // namespace eg::io
