#include "services/bridge/cloud_map.hpp"

#include <algorithm>

namespace eg::services {
namespace {

constexpr std::size_t kMaxParts = 4096;
constexpr std::size_t kMaxPointsOfPart = 256;
constexpr std::size_t kMaxPoints = 10'000;  // 160 kB

/// Every how many-th of `available` to take so that at most `wanted` remain.
std::size_t step(std::size_t available, std::size_t wanted) {
  return std::max<std::size_t>(1, (available + wanted - 1) / wanted);
}

}  // namespace

void CloudMap::add(const mapping::MeshChunk& chunk) {
  const std::pair<Tile, std::int32_t> key = {{chunk.tile.x(), chunk.tile.y(), chunk.tile.z()}, chunk.part};
  const auto known = parts_.find(key);
  if (known == parts_.end() && parts_.size() >= kMaxParts) return;
  if (known != parts_.end() && chunk.revision <= known->second.revision) return;
  Part& part = parts_[key];
  part.revision = chunk.revision;
  part.points.clear();
  const mapping::Mesh& mesh = chunk.mesh;
  for (std::size_t i = 0; i < mesh.vertices.size(); i += step(mesh.vertices.size(), kMaxPointsOfPart)) {
    part.points.push_back({mesh.vertices[i], mesh.colours[i]});
  }
}

messages::bot::PointCloud CloudMap::cloud() const {
  std::size_t available = 0;
  for (const auto& [key, part] : parts_) available += part.points.size();
  const std::size_t every = step(available, kMaxPoints);
  messages::bot::PointCloud cloud;
  std::size_t next = 0;
  for (const auto& [key, part] : parts_) {
    for (const auto& point : part.points) {
      if (next++ % every == 0) cloud.points.push_back(point);
    }
  }
  return cloud;
}

}  // namespace eg::services
