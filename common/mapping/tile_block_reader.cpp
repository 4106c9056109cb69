#include "common/mapping/tile_block_reader.hpp"

#include <algorithm>
#include <tuple>

namespace eg::mapping {
namespace {

constexpr int kTilesPerShare = 4;  // side of a share's cubes

int floor_divide(int value, int divisor) { return (value >= 0 ? value : value - divisor + 1) / divisor; }

/// NaN where there is none.
Eigen::Vector3f mean_colour(const openvdb::Vec4i& sums) {
  return Eigen::Vector3i(sums[0], sums[1], sums[2]).cast<float>() / static_cast<float>(sums[3]);
}

void read_leaf(const TsdfGrids& grids, const TsdfUnits& units, const IntLeaf& weights, TileBlock& block) {
  const openvdb::Coord origin = weights.origin();
  const std::int32_t* const weight = weights.buffer().data();
  const std::int32_t* const distance = grids.distance.probeConstLeaf(origin)->buffer().data();
  const openvdb::Vec4i* const colour = grids.colour_sums(origin);
  const Eigen::Vector3i shift = Eigen::Vector3i(origin.x(), origin.y(), origin.z()) - block.first_voxel;
  const Eigen::Vector3i first = (-shift).cwiseMax(0);
  const Eigen::Vector3i last = (Eigen::Vector3i::Constant(TileBlock::kSide) - shift).cwiseMin(kLeafSide);
  for (int x = first.x(); x < last.x(); ++x) {
    for (int y = first.y(); y < last.y(); ++y) {
      for (int z = first.z(); z < last.z(); ++z) {
        const auto from = static_cast<std::size_t>((x * kLeafSide + y) * kLeafSide + z);
        if (weight[from] == 0) continue;
        const auto to = static_cast<std::size_t>(TileBlock::index(x + shift.x(), y + shift.y(), z + shift.z()));
        const float scale = 1.0F / static_cast<float>(weight[from]);
        block.distance[to] = units.metres_per_step() * scale * static_cast<float>(distance[from]);
        if (colour != nullptr) block.colour[to] = mean_colour(colour[from]);
      }
    }
  }
}

}  // namespace

TileBlock read_tile(const TsdfGrids& grids, const TsdfUnits& units, const Eigen::Vector3i& tile) {
  TileBlock block(tile);
  const Eigen::Vector3i last_voxel = block.first_voxel + Eigen::Vector3i::Constant(TileBlock::kSide - 1);
  openvdb::Coord origin;
  for (int x = floor_divide(block.first_voxel.x(), kLeafSide); x <= floor_divide(last_voxel.x(), kLeafSide); ++x) {
    for (int y = floor_divide(block.first_voxel.y(), kLeafSide); y <= floor_divide(last_voxel.y(), kLeafSide); ++y) {
      for (int z = floor_divide(block.first_voxel.z(), kLeafSide); z <= floor_divide(last_voxel.z(), kLeafSide); ++z) {
        origin.reset(x * kLeafSide, y * kLeafSide, z * kLeafSide);
        const IntLeaf* const leaf = grids.weight->probeConstLeaf(origin);
        if (leaf != nullptr) read_leaf(grids, units, *leaf, block);
      }
    }
  }
  return block;
}

std::vector<Eigen::Vector3i> tiles_with_leaves(const TsdfGrids& grids) {
  std::vector<Eigen::Vector3i> tiles;
  for (auto leaf = grids.weight->cbeginLeaf(); leaf; ++leaf) {
    const openvdb::Coord& origin = leaf->origin();
    tiles.emplace_back(floor_divide(origin.x(), kTileSide), floor_divide(origin.y(), kTileSide),
                       floor_divide(origin.z(), kTileSide));
  }
  sort_unique(tiles);
  return tiles;
}

void append_tiles_around_leaf(const Eigen::Vector3i& leaf, std::vector<Eigen::Vector3i>& tiles) {
  // A cell depends on the voxels from one before it to two after it.
  const auto first = [&](int axis) { return floor_divide(leaf[axis] * kLeafSide - 2, kTileSide); };
  const auto last = [&](int axis) { return floor_divide(leaf[axis] * kLeafSide + kLeafSide, kTileSide); };
  for (int x = first(0); x <= last(0); ++x) {
    for (int y = first(1); y <= last(1); ++y) {
      for (int z = first(2); z <= last(2); ++z) tiles.emplace_back(x, y, z);
    }
  }
}

void append_tiles_around_tile(const Eigen::Vector3i& tile, std::vector<Eigen::Vector3i>& tiles) {
  for (int i = 0; i < 27; ++i) tiles.emplace_back(tile + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
}

bool is_owned(const TsdfOptions& options, const Eigen::Vector3i& tile) {
  const int cubes = floor_divide(tile.x(), kTilesPerShare) + floor_divide(tile.y(), kTilesPerShare) +
                    floor_divide(tile.z(), kTilesPerShare);
  return cubes - options.shares * floor_divide(cubes, options.shares) == options.share;
}

bool is_needed(const TsdfOptions& options, const Eigen::Vector3i& leaf) {
  if (options.shares == 1) return true;
  std::vector<Eigen::Vector3i> tiles;
  append_tiles_around_leaf(leaf, tiles);
  return std::any_of(tiles.begin(), tiles.end(), [&](const Eigen::Vector3i& tile) { return is_owned(options, tile); });
}

void sort_unique(std::vector<Eigen::Vector3i>& tiles) {
  std::sort(tiles.begin(), tiles.end(), [](const Eigen::Vector3i& a, const Eigen::Vector3i& b) {
    return std::tie(a.x(), a.y(), a.z()) < std::tie(b.x(), b.y(), b.z());
  });
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
}

}  // namespace eg::mapping
