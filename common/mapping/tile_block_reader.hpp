#pragma once

#include "common/mapping/tile_mesher.hpp"
#include "common/mapping/tsdf_grids.hpp"

namespace eg::mapping {

/// Copies the voxels that a tile's surface depends on out of the trees and turns their sums into means.
TileBlock read_tile(const TsdfGrids& grids, const TsdfUnits& units, const Eigen::Vector3i& tile);

/// Tiles that hold leaves, in lexicographic order.
std::vector<Eigen::Vector3i> tiles_with_leaves(const TsdfGrids& grids);

/// Adds the tiles whose surface depends on a voxel of the leaf (number = origin / leaf side).
void append_tiles_around_leaf(const Eigen::Vector3i& leaf, std::vector<Eigen::Vector3i>& tiles);

/// Adds the tile and those around it, whose surface depends on its voxels.
void append_tiles_around_tile(const Eigen::Vector3i& tile, std::vector<Eigen::Vector3i>& tiles);

/// Whether a tile belongs to this map's share. Shares are cubes of several tiles: what lies around them, which is
/// mapped twice, is then little.
bool is_owned(const TsdfOptions& options, const Eigen::Vector3i& tile);

/// Whether the surface of a tile of this map's share depends on a voxel of the leaf (number = origin / leaf side).
bool is_needed(const TsdfOptions& options, const Eigen::Vector3i& leaf);

/// Sorts lexicographically and removes repetitions.
void sort_unique(std::vector<Eigen::Vector3i>& tiles);

}  // namespace eg::mapping
