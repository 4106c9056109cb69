#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/mapping/mesh.hpp"

/// Polygon files (PLY, Turk 1994): meshes, coloured point clouds and line sets, in one form.
namespace eg::io {

/// What a PLY file holds. Normals and colours: none, or one per vertex. Indices refer to vertices.
struct PlyData {
  std::vector<Eigen::Vector3f> vertices;  ///< metres
  std::vector<Eigen::Vector3f> normals;
  std::vector<mapping::Colour> colours;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<std::uint32_t, 2>> edges;
};

/// The same without owning it: what is written.
struct PlyView {
  std::span<const Eigen::Vector3f> vertices;
  std::span<const Eigen::Vector3f> normals = {};
  std::span<const mapping::Colour> colours = {};
  std::span<const std::array<std::uint32_t, 3>> triangles = {};
  std::span<const std::array<std::uint32_t, 2>> edges = {};
};
PlyView view_of(const PlyData& data);
PlyView view_of(const mapping::Mesh& mesh);

/// Binary little-endian PLY. Elements that are empty are left out, except vertices.
std::string format_ply(const PlyView& data);

/// Written whole or not at all.
base::Status write_ply(const std::filesystem::path& path, const PlyView& data);

/// Reads ASCII and binary little-endian PLY, also as other programs write it: coordinates as float or double, colours
/// as uchar, polygons (cut into triangles from their first corner); further elements and properties are skipped.
/// Errors: no PLY, no coordinates, vertices in two places, an unknown type, less data than the header promises,
/// coordinates that are not finite, indices out of range.
base::Result<PlyData> read_ply(const std::filesystem::path& path);

}  // namespace eg::io
