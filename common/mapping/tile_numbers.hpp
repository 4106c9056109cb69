#pragma once

#include <Eigen/Core>
#include <tuple>
#include <vector>

#include "common/mapping/tsdf_options.hpp"

namespace eg::mapping {

/// Cells per side of a tile.
inline constexpr int kTileSide = 32;

inline int floor_divide(int value, int divisor) { return (value >= 0 ? value : value - divisor + 1) / divisor; }

inline Eigen::Vector3i floor_divide(const Eigen::Vector3i& values, int divisor) {
  return values.unaryExpr([divisor](int value) { return floor_divide(value, divisor); });
}

/// Lexicographic.
struct TileOrder {
  bool operator()(const Eigen::Vector3i& a, const Eigen::Vector3i& b) const {
    return std::tie(a.x(), a.y(), a.z()) < std::tie(b.x(), b.y(), b.z());
  }
};

/// Sorts lexicographically and removes repetitions.
void sort_unique(std::vector<Eigen::Vector3i>& tiles);

/// The tiles that leaves (numbers = origin / leaf side) lie in, in lexicographic order.
std::vector<Eigen::Vector3i> tiles_of_leaves(const std::vector<Eigen::Vector3i>& leaves);

/// The tiles whose surface depends on a voxel of the leaves (numbers = origin / leaf side), in lexicographic order.
std::vector<Eigen::Vector3i> tiles_around_leaves(const std::vector<Eigen::Vector3i>& leaves);

/// Adds the tile and those around it, whose surface depends on its voxels and its own on theirs.
void append_tiles_around_tile(const Eigen::Vector3i& tile, std::vector<Eigen::Vector3i>& tiles);

/// Whether a tile belongs to this map's share. Shares are cubes of several tiles: what lies around them, which is
/// mapped twice, is then little.
bool is_owned(const TsdfOptions& options, const Eigen::Vector3i& tile);

/// Whether the surface of a tile of this map's share depends on a voxel of the leaf (number = origin / leaf side).
bool is_needed(const TsdfOptions& options, const Eigen::Vector3i& leaf);

}  // namespace eg::mapping
