#include "common/mapping/tile_numbers.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "common/mapping/number_list.hpp"
#include "common/mapping/tsdf_grids.hpp"

namespace eg::mapping {
namespace {

constexpr int kTilesPerShare = 4;  // side of a share's cubes

/// Tells `take` the tiles whose surface depends on a voxel of the leaf.
template <typename Take>
void for_tiles_around_leaf(const Eigen::Vector3i& leaf, const Take& take) {
  // A cell depends on the voxels from one before it to two after it.
  const Eigen::Vector3i first = floor_divide((kLeafSide * leaf).array() - 2, kTileSide);
  const Eigen::Vector3i last = floor_divide((kLeafSide * leaf).array() + kLeafSide, kTileSide);
  for (int x = first.x(); x <= last.x(); ++x) {
    for (int y = first.y(); y <= last.y(); ++y) {
      for (int z = first.z(); z <= last.z(); ++z) take(Eigen::Vector3i(x, y, z));
    }
  }
}

}  // namespace

void sort_unique(std::vector<Eigen::Vector3i>& tiles) {
  std::sort(tiles.begin(), tiles.end(), TileOrder());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
}

std::vector<Eigen::Vector3i> tiles_of_leaves(const std::vector<Eigen::Vector3i>& leaves) {
  NumberList tiles;
  for (const Eigen::Vector3i& leaf : leaves) tiles.add(floor_divide(leaf, kTileSide / kLeafSide));
  return unpacked(std::move(tiles).sorted());
}

std::vector<Eigen::Vector3i> tiles_around_leaves(const std::vector<Eigen::Vector3i>& leaves) {
  NumberList tiles;
  for (const Eigen::Vector3i& leaf : leaves) {
    for_tiles_around_leaf(leaf, [&](const Eigen::Vector3i& tile) { tiles.add(tile); });
  }
  return unpacked(std::move(tiles).sorted());
}

void append_tiles_around_tile(const Eigen::Vector3i& tile, std::vector<Eigen::Vector3i>& tiles) {
  for (int i = 0; i < 27; ++i) tiles.emplace_back(tile + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
}

bool is_owned(const TsdfOptions& options, const Eigen::Vector3i& tile) {
  const int cubes = floor_divide(tile, kTilesPerShare).sum();
  return cubes - options.shares * floor_divide(cubes, options.shares) == options.share;
}

bool is_needed(const TsdfOptions& options, const Eigen::Vector3i& leaf) {
  if (options.shares == 1) return true;
  bool found = false;
  for_tiles_around_leaf(leaf, [&](const Eigen::Vector3i& tile) { found = found || is_owned(options, tile); });
  return found;
}

}  // namespace eg::mapping
