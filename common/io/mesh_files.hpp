#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "common/base/result.hpp"
#include "common/mapping/mesh.hpp"

namespace eg::io {

/// Writes a mesh that is too large to be held, piece by piece, as STEM.ply and as the cloud of its vertices STEM.pcd:
/// the same bytes as write_ply() and write_pcd(). What has come waits in the same folder, in files without a name.
class MeshFiles {
 public:
  static base::Result<MeshFiles> create(const std::filesystem::path& stem);

  /// Vertices behind all that have come before, and triangles between the vertices of all pieces so far.
  base::Status add(const mapping::Mesh& piece);

  /// Each of the two files is written whole or not at all.
  base::Status finish();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;

  MeshFiles(std::filesystem::path stem, File vertices, File triangles);

  static base::Result<File> nameless_file(const std::filesystem::path& stem);
  [[nodiscard]] base::Status write_ply_file() const;
  [[nodiscard]] base::Status write_pcd_file() const;

  std::filesystem::path stem_;
  File vertices_;   ///< rows of a PLY file
  File triangles_;  ///< the same
  std::size_t vertex_count_ = 0;
  std::size_t triangle_count_ = 0;
};

}  // namespace eg::io
