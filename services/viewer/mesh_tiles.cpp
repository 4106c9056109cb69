#include "services/viewer/mesh_tiles.hpp"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "services/viewer/arrays.hpp"
#include "services/viewer/packet.hpp"

namespace eg::services {
namespace {

constexpr std::size_t kMaxTiles = 100'000;
constexpr std::int32_t kMaxParts = 64;
constexpr float kLargest16 = 65535.0F;
constexpr float kLargest8 = 127.0F;

using Parts = std::map<std::int32_t, mapping::Mesh>;

Eigen::AlignedBox3f bounds_of(const Parts& parts) {
  Eigen::AlignedBox3f box;
  for (const auto& [number, mesh] : parts) {
    for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex);
  }
  return box;
}

/// Per vertex: four 16-bit numbers, the last one for alignment. One scale for all axes, so that normals need none.
std::vector<std::uint16_t> positions_of(const Parts& parts, const Eigen::AlignedBox3f& box) {
  const float steps_per_metre = kLargest16 / std::max(box.sizes().maxCoeff(), 1e-6F);
  std::vector<std::uint16_t> positions;
  for (const auto& [number, mesh] : parts) {
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      const Eigen::Array3f steps = ((vertex - box.min()).array() * steps_per_metre).round().min(kLargest16);
      for (const float step : steps) positions.push_back(static_cast<std::uint16_t>(step));
      positions.push_back(0);
    }
  }
  return positions;
}

std::vector<std::int8_t> normals_of(const Parts& parts) {
  std::vector<std::int8_t> normals;
  for (const auto& [number, mesh] : parts) {
    for (const Eigen::Vector3f& normal : mesh.normals) {
      for (const float x : normal) normals.push_back(static_cast<std::int8_t>(std::lround(x * kLargest8)));
      normals.push_back(0);
    }
  }
  return normals;
}

std::vector<std::uint8_t> colours_of(const Parts& parts) {
  std::vector<std::uint8_t> colours;
  for (const auto& [number, mesh] : parts) {
    for (const mapping::Colour& colour : mesh.colours) {
      colours.insert(colours.end(), colour.begin(), colour.end());
      colours.push_back(255);
    }
  }
  return colours;
}

template <typename Index>
std::vector<Index> indices_of(const Parts& parts) {
  std::vector<Index> indices;
  std::size_t first_vertex = 0;
  for (const auto& [number, mesh] : parts) {
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t vertex : triangle) indices.push_back(static_cast<Index>(first_vertex + vertex));
    }
    first_vertex += mesh.vertices.size();
  }
  return indices;
}

}  // namespace

bool MeshTiles::add(const mapping::MeshChunk& chunk) {
  const Number number{chunk.tile.x(), chunk.tile.y(), chunk.tile.z()};
  if (chunk.parts > kMaxParts || (!tiles_.contains(number) && tiles_.size() >= kMaxTiles)) return false;
  Tile& tile = tiles_[number];
  if (chunk.revision <= tile.shown) return true;  // the mapper says again what it has said
  if (chunk.revision != tile.coming) {
    tile.coming = chunk.revision;
    tile.parts.clear();
  }
  tile.parts.insert_or_assign(chunk.part, chunk.mesh);
  if (tile.parts.size() < static_cast<std::size_t>(chunk.parts)) return true;
  const bool put =
      board_.put(fmt::format("tile/{}/{}/{}", number[0], number[1], number[2]), tile_packet(chunk, tile.parts));
  tile = {put ? chunk.revision : -1, -1, {}};
  return put;
}

void MeshTiles::forget_revisions() {
  for (auto& [number, tile] : tiles_) tile = {};
}

std::vector<std::uint8_t> tile_packet(const mapping::MeshChunk& chunk, const Parts& parts) {
  const Eigen::AlignedBox3f box = bounds_of(parts);
  const std::vector<std::uint16_t> positions = positions_of(parts, box);
  std::vector<float> bounds;
  if (!box.isEmpty()) {
    append(bounds, box.min());
    append(bounds, box.max());
  }
  Packet packet("tile");
  packet.set("edge", chunk.tile_size)
      .array("tile", std::span<const std::int32_t>(chunk.tile.data(), 3))
      .array("bounds", bounds)
      .array("positions", positions)
      .array("normals", normals_of(parts))
      .array("colours", colours_of(parts));
  // A browser's graphics library holds short indices in half the memory.
  const bool few = positions.size() / 4 <= 65'536;
  few ? packet.array("indices", indices_of<std::uint16_t>(parts))
      : packet.array("indices", indices_of<std::uint32_t>(parts));
  return packet.bytes();
}

}  // namespace eg::services
