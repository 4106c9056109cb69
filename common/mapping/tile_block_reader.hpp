#pragma once

#include "common/mapping/tile_mesher.hpp"
#include "common/mapping/tsdf_grids.hpp"

namespace eg::mapping {

/// Copies the voxels that a tile's surface depends on out of the trees and turns their sums into means.
TileBlock read_tile(const TsdfGrids& grids, const TsdfUnits& units, const Eigen::Vector3i& tile);

/// Tiles that hold leaves, in lexicographic order.
std::vector<Eigen::Vector3i> tiles_with_leaves(const TsdfGrids& grids);

}  // namespace eg::mapping
