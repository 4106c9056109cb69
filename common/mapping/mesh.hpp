#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace eg::mapping {

using Colour = std::array<std::uint8_t, 3>;  ///< red, green, blue

/// A coloured triangle mesh in the world frame.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;                ///< metres
  std::vector<Eigen::Vector3f> normals;                 ///< unit, out of the surface; one per vertex
  std::vector<Colour> colours;                          ///< one per vertex
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices, counter-clockwise seen from outside
};

/// Part of the map's mesh: the surface inside one cube of space. A newer revision replaces an older one.
struct MeshChunk {
  std::int64_t session = 0;
  Eigen::Vector3i tile = Eigen::Vector3i::Zero();  ///< tile number along x, y, z
  std::int32_t revision = 0;
  std::int32_t part = 0;  ///< a tile too large for one message comes in several parts
  std::int32_t parts = 1;
  double tile_size = 0.0;  ///< edge length, metres
  Mesh mesh;               ///< at most 65535 vertices
};

}  // namespace eg::mapping
