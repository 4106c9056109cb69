#include "common/mapping/tile_block_reader.hpp"

namespace eg::mapping {
namespace {

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
        const IntLeaf* const leaf = grids.weight.probeConstLeaf(origin);
        if (leaf != nullptr) read_leaf(grids, units, *leaf, block);
      }
    }
  }
  return block;
}

std::vector<Eigen::Vector3i> tiles_with_leaves(const TsdfGrids& grids) {
  std::vector<Eigen::Vector3i> tiles;
  for (auto leaf = grids.weight.cbeginLeaf(); leaf; ++leaf) {
    const openvdb::Coord& origin = leaf->origin();
    tiles.push_back(floor_divide(Eigen::Vector3i(origin.x(), origin.y(), origin.z()), kTileSide));
  }
  sort_unique(tiles);
  return tiles;
}

}  // namespace eg::mapping
