#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "common/mapping/mesh.hpp"
#include "common/messages/bot.hpp"

namespace eg::services {

/// The vertices of a map's mesh, thinned evenly so that all of them fit into one message.
class CloudMap {
 public:
  /// Takes the place of an older revision of this part of the mesh. Beyond so many parts new ones are left out.
  void add(const mapping::MeshChunk& chunk);

  [[nodiscard]] bool empty() const { return parts_.empty(); }

  /// At most 10000 points, in the mesh's frame.
  [[nodiscard]] messages::bot::PointCloud cloud() const;

 private:
  using Tile = std::array<int, 3>;
  struct Part {
    std::int32_t revision = 0;
    std::vector<messages::bot::PointCloud::Point> points;
  };

  std::map<std::pair<Tile, std::int32_t>, Part> parts_;
};

}  // namespace eg::services
