#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/mapping/mesh.hpp"
#include "common/mapping/tile_numbers.hpp"

namespace eg::mapping {

/// The field at the corners of a tile's cells and one voxel around them, which the gradient needs.
struct TileBlock {
  static constexpr int kSide = kTileSide + 3;
  static constexpr int kStride[3] = {kSide * kSide, kSide, 1};  ///< from a voxel to the next along x, y, z

  Eigen::Vector3i first_voxel;          ///< voxel at index 0: the tile's lowest corner less (1, 1, 1)
  std::vector<float> distance;          ///< signed, metres; NaN where not observed
  std::vector<Eigen::Vector3f> colour;  ///< red, green, blue in [0, 255]; NaN where not known

  explicit TileBlock(const Eigen::Vector3i& tile);

  [[nodiscard]] static int index(int x, int y, int z) { return x * kStride[0] + y * kStride[1] + z; }
};

/// The surface inside a tile.
struct TileMesh {
  /// A vertex that neighbouring tiles have too. The key names the edge of the grid that it lies on.
  struct BorderVertex {
    std::uint64_t key = 0;
    std::uint32_t vertex = 0;
  };

  Mesh mesh;
  std::vector<BorderVertex> border;
};

/// Marching cubes over the cells whose eight corners are observed and between whose corners the field has no jump above
/// `max_step` metres (at a depth edge the front of one surface and the back of another meet, and there is none).
TileMesh mesh_tile(const TileBlock& block, double voxel_size, double max_step);

}  // namespace eg::mapping
