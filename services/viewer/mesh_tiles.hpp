#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/mapping/mesh.hpp"
#include "services/viewer/board.hpp"

namespace eg::services {

/// Puts the mesh on the board, tile by tile: each once all parts of a newer revision have come. Positions have 16 bits
/// within the tile's bounds (0.02 mm in a tile of 1.3 m), normals 8: a vertex is 16 bytes.
class MeshTiles {
 public:
  explicit MeshTiles(Board& board) : board_(board) {}

  /// False: the chunk is beyond what is kept, or the board is full.
  bool add(const mapping::MeshChunk& chunk);

  /// A mapper that starts again counts its revisions from the beginning: what comes next is newer.
  void forget_revisions();

  /// Forgets everything; the board is somebody else's to clear.
  void clear() { tiles_.clear(); }

 private:
  using Number = std::array<int, 3>;
  struct Tile {
    std::int32_t shown = -1;   ///< revision on the board
    std::int32_t coming = -1;  ///< revision whose parts are being collected
    std::map<std::int32_t, mapping::Mesh> parts;
  };

  Board& board_;
  std::map<Number, Tile> tiles_;
};

/// The packet "tile" of the whole mesh of a chunk's tile; an empty mesh makes an empty tile.
std::vector<std::uint8_t> tile_packet(const mapping::MeshChunk& chunk,
                                      const std::map<std::int32_t, mapping::Mesh>& parts);

}  // namespace eg::services
