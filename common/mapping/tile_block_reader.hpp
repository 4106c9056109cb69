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

/// Sorts lexicographically and removes repetitions.
void sort_unique(std::vector<Eigen::Vector3i>& tiles);

}  // namespace eg::mapping
