#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "common/base/result.hpp"
#include "common/mapping/tsdf_grids.hpp"

namespace eg::mapping {

/// The sums of all leaves of one tile as bytes, to the last bit; packed with zstd. They know nothing of the tile's
/// place, and they have no checksum of their own. Little-endian machines only, as everything that this project runs on.
std::string pack_tile(const TsdfGrids& grids, const Eigen::Vector3i& tile);

/// Puts the leaves of a packed tile where the tile is, which must be empty. Refuses what pack_tile() does not write and
/// sums out of range; the grids are then untouched.
base::Status unpack_tile(std::string_view bytes, const Eigen::Vector3i& tile, TsdfGrids& grids);

/// Whether any leaf lies in a tile.
bool holds_leaves(const TsdfGrids& grids, const Eigen::Vector3i& tile);

/// Removes the leaves of a tile.
void erase_tile(const Eigen::Vector3i& tile, TsdfGrids& grids);

}  // namespace eg::mapping
