#include "common/mapping/tile_numbers.hpp"

#include <algorithm>

#include "common/mapping/tsdf_grids.hpp"

namespace eg::mapping {
namespace {

constexpr int kTilesPerShare = 4;  // side of a share's cubes

}  // namespace

void sort_unique(std::vector<Eigen::Vector3i>& tiles) {
  std::sort(tiles.begin(), tiles.end(), TileOrder());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
}

std::vector<Eigen::Vector3i> tiles_of_leaves(const std::vector<Eigen::Vector3i>& leaves) {
  std::vector<Eigen::Vector3i> tiles;
  for (const Eigen::Vector3i& leaf : leaves) {
    const Eigen::Vector3i tile = floor_divide(leaf, kTileSide / kLeafSide);
    if (tiles.empty() || tiles.back() != tile) tiles.push_back(tile);
  }
  sort_unique(tiles);
  return tiles;
}

void append_tiles_around_leaf(const Eigen::Vector3i& leaf, std::vector<Eigen::Vector3i>& tiles) {
  // A cell depends on the voxels from one before it to two after it.
  const Eigen::Vector3i first = floor_divide((kLeafSide * leaf).array() - 2, kTileSide);
  const Eigen::Vector3i last = floor_divide((kLeafSide * leaf).array() + kLeafSide, kTileSide);
  for (int x = first.x(); x <= last.x(); ++x) {
    for (int y = first.y(); y <= last.y(); ++y) {
      for (int z = first.z(); z <= last.z(); ++z) tiles.emplace_back(x, y, z);
    }
  }
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
  std::vector<Eigen::Vector3i> tiles;
  append_tiles_around_leaf(leaf, tiles);
  return std::any_of(tiles.begin(), tiles.end(), [&](const Eigen::Vector3i& tile) { return is_owned(options, tile); });
}

}  // namespace eg::mapping
