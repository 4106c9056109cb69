#include "services/mapper/mesh_stream.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

#include "common/mapping/mesh_parts.hpp"

namespace eg::services {
namespace {

// LCM loses most messages that are larger; the rest of a chunk takes some 70 bytes.
constexpr std::size_t kMaxMeshBytes = 180'000 - 100;
constexpr int kTilesPerRound = 4;

std::vector<mapping::MeshChunk> make_chunks(const mapping::Mesh& mesh, const Eigen::Vector3i& tile, double tile_size,
                                            std::int32_t revision, std::int64_t session) {
  std::vector<mapping::Mesh> parts = mapping::split_mesh(mesh, kMaxMeshBytes);
  std::vector<mapping::MeshChunk> chunks;
  for (mapping::Mesh& part : parts) {
    mapping::MeshChunk& chunk = chunks.emplace_back();
    chunk.session = session;
    chunk.tile = tile;
    chunk.revision = revision;
    chunk.part = static_cast<std::int32_t>(chunks.size() - 1);
    chunk.parts = static_cast<std::int32_t>(parts.size());
    chunk.tile_size = tile_size;
    chunk.mesh = std::move(part);
  }
  return chunks;
}

}  // namespace

base::Result<MeshStream::Chunks> MeshStream::next(mapping::TsdfMap& map, std::int64_t session, std::int64_t now_utime) {
  if (period_ == 0) return Chunks();
  if (!changed_.empty()) return send_changed(map, session);
  if (!asked_for_.empty()) return send_asked_for(map, session);
  if (now_utime < next_collection_) return Chunks();
  next_collection_ = now_utime + period_;
  collect_changes(map);
  return changed_.empty() ? send_again(map, session) : send_changed(map, session);
}

void MeshStream::repeat_all() {
  for (const auto& [tile, revision] : revisions_) asked_for_.insert(tile);
}

void MeshStream::collect_changes(mapping::TsdfMap& map) {
  for (const Eigen::Vector3i& tile : map.take_changed_tiles()) changed_.insert({tile.x(), tile.y(), tile.z()});
}

base::Result<MeshStream::Chunks> MeshStream::send_changed(const mapping::TsdfMap& map, std::int64_t session) {
  Chunks chunks;
  for (int sent = 0; sent < kTilesPerRound && !changed_.empty();) {
    const Tile tile = changed_.extract(changed_.begin()).value();
    const Eigen::Vector3i number(tile[0], tile[1], tile[2]);
    const auto mesh = map.extract_tile(number);
    if (!mesh) return tl::make_unexpected(mesh.error());
    const auto known = revisions_.find(tile);
    if (mesh->triangles.empty() && known == revisions_.end()) continue;  // it never had a surface
    const std::int32_t revision = known == revisions_.end() ? 0 : known->second + 1;
    revisions_[tile] = revision;
    auto parts = make_chunks(*mesh, number, map.tile_size(), revision, session);
    std::move(parts.begin(), parts.end(), std::back_inserter(chunks));
    ++sent;
  }
  return chunks;
}

base::Result<MeshStream::Chunks> MeshStream::send_asked_for(const mapping::TsdfMap& map, std::int64_t session) {
  Chunks chunks;
  for (int sent = 0; sent < kTilesPerRound && !asked_for_.empty(); ++sent) {
    auto parts = repeat(map, session, asked_for_.extract(asked_for_.begin()).value());
    if (!parts) return parts;
    std::move(parts->begin(), parts->end(), std::back_inserter(chunks));
  }
  return chunks;
}

base::Result<MeshStream::Chunks> MeshStream::send_again(const mapping::TsdfMap& map, std::int64_t session) {
  if (revisions_.empty()) return Chunks();
  auto known = revisions_.upper_bound(last_repeated_);
  if (known == revisions_.end()) known = revisions_.begin();
  last_repeated_ = known->first;
  return repeat(map, session, last_repeated_);
}

base::Result<MeshStream::Chunks> MeshStream::repeat(const mapping::TsdfMap& map, std::int64_t session,
                                                    const Tile& tile) {
  const Eigen::Vector3i number(tile[0], tile[1], tile[2]);
  return map.extract_tile(number).map([&](const mapping::Mesh& mesh) {
    return make_chunks(mesh, number, map.tile_size(), revisions_.at(tile), session);
  });
}

}  // namespace eg::services
