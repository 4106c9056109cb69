#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>

#include "common/mapping/tile_mesher.hpp"

namespace eg::mapping {

/// Joins tiles at their common vertices, one after the other: it remembers no more than the borders of two layers of
/// tiles.
class MeshWelder {
 public:
  /// Takes the tiles in lexicographic order of their numbers. What it gives are the vertices that no tile before had,
  /// and triangles between the vertices of all that it has given so far, counted through.
  Mesh add(const Eigen::Vector3i& tile, TileMesh mesh);

 private:
  using VertexOfEdge = std::unordered_map<std::uint64_t, std::uint32_t>;

  void begin_layer(int x);
  [[nodiscard]] std::uint32_t find(std::uint64_t key) const;

  int layer_ = 0;  ///< x of the last tile
  VertexOfEdge here_;
  VertexOfEdge before_;  ///< in the layer before
  std::uint32_t vertices_ = 0;
};

}  // namespace eg::mapping
