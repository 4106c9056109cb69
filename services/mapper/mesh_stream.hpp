#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "common/mapping/mesh.hpp"
#include "common/mapping/tsdf_map.hpp"

namespace eg::services {

/// Decides which tiles of the mesh are sent when. Changed tiles are collected once a period and sent a few at a time,
/// so that no receiver's buffer overflows; while nothing changes, all tiles are sent round and round with the revision
/// they have, so that a viewer that lost a message or came late gets whole.
class MeshStream {
 public:
  using Chunks = std::vector<mapping::MeshChunk>;

  /// @param period microseconds between two collections of changed tiles; 0: nothing is ever sent
  explicit MeshStream(std::int64_t period) : period_(period) {}

  /// Somebody lacks the mesh: every tile that was sent is sent again, soon.
  void repeat_all();

  /// What to send now. An empty chunk says that a tile has no surface any more. Fails when the map cannot bring back
  /// what a tile depends on; the next call goes on with the next tile.
  base::Result<Chunks> next(mapping::TsdfMap& map, std::int64_t session, std::int64_t now_utime);

 private:
  using Tile = std::array<int, 3>;

  void collect_changes(mapping::TsdfMap& map);
  [[nodiscard]] base::Result<Chunks> send_changed(const mapping::TsdfMap& map, std::int64_t session);
  [[nodiscard]] base::Result<Chunks> send_asked_for(const mapping::TsdfMap& map, std::int64_t session);
  [[nodiscard]] base::Result<Chunks> send_again(const mapping::TsdfMap& map, std::int64_t session);
  [[nodiscard]] base::Result<Chunks> repeat(const mapping::TsdfMap& map, std::int64_t session, const Tile& tile);

  std::int64_t period_;
  std::int64_t next_collection_ = 0;
  std::set<Tile> changed_;
  std::map<Tile, std::int32_t> revisions_;  ///< of tiles that were sent
  std::set<Tile> asked_for_;                ///< tiles to be repeated soon
  Tile last_repeated_{};
};

}  // namespace eg::services
