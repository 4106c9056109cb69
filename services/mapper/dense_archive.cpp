#include "services/mapper/dense_archive.hpp"

#include <array>
#include <cstring>
#include <string>

#include "common/service/map_archive.hpp"

namespace eg::services {
namespace {

using service::bytes_of;
using service::text_of;
using TileNumber = std::array<std::int32_t, 3>;

/// In this order: one of options, tiles, images of keyframes, each with planes behind it if there are any, then one of
/// poses, which stands for the end.
enum class RecordKind : std::uint8_t { options = 0, tile = 1, images = 2, poses = 3, planes = 4 };

/// Planes are no part of it: archives from before there were any can still be read, and the decoder of FEATURES refuses
/// what it does not know.
std::uint64_t schema() { return service::schema_of<messages::CompressedFrame, tracking::PoseCorrection>(); }

/// What the grids' units and shares depend on, for people and to be compared.
std::string describe(const mapping::TsdfOptions& options) {
  const auto number = [](double value) {
    std::string text = std::to_string(value);
    return text.erase(text.find_last_not_of('0') + 1);
  };
  return "voxel_size " + number(options.voxel_size) + ", min_depth " + number(options.min_depth) + ", max_depth " +
         number(options.max_depth) + ", truncation_voxels " + number(options.truncation_voxels) +
         ", truncation_sigmas " + number(options.truncation_sigmas) + ", share " + std::to_string(options.share) +
         " of " + std::to_string(options.shares);
}

/// Bytes behind a head of a few integers.
template <typename Head>
std::string with_head(const Head& head, std::string_view bytes) {
  std::string record(reinterpret_cast<const char*>(&head), sizeof head);
  return record.append(bytes);
}

template <typename Head>
bool take_head(std::string_view& bytes, Head& head) {
  if (bytes.size() < sizeof head) return false;
  std::memcpy(&head, bytes.data(), sizeof head);
  bytes.remove_prefix(sizeof head);
  return true;
}

class Reader {
 public:
  explicit Reader(KeyframeMap& map) : map_(map) {}

  base::Status add(const io::JournalRecord& record) {
    const auto kind = static_cast<RecordKind>(record.kind);
    if (!has_options_ && kind != RecordKind::options) return base::fail("comes before the options");
    switch (kind) {
      case RecordKind::options:
        return add_options(record.bytes);
      case RecordKind::tile:
        return add_tile(record.bytes);
      case RecordKind::images:
        return add_images(record.bytes);
      case RecordKind::planes:
        return add_planes(record.bytes);
      case RecordKind::poses:
        return add_poses(record.bytes);
    }
    return base::fail("is of an unknown kind");
  }

  [[nodiscard]] bool is_complete() const { return is_complete_; }

 private:
  base::Status add_options(std::string_view bytes) {
    const std::string own = describe(map_.field().options());
    if (bytes != own) return base::fail("the map was made with " + std::string(bytes) + "; this mapper has " + own);
    has_options_ = true;
    return {};
  }

  base::Status add_tile(std::string_view bytes) {
    constexpr std::int32_t kFarthest = 1 << 20;  // tiles; kilometres at the smallest voxel size
    TileNumber tile{};
    if (!take_head(bytes, tile)) return base::fail("is cut short");
    for (const std::int32_t axis : tile) {
      if (axis < -kFarthest || axis > kFarthest) return base::fail("has a tile out of range");
    }
    auto unpacked = map_.field().unpack_tile({tile[0], tile[1], tile[2]}, bytes);
    return unpacked ? map_.field().keep_budget() : unpacked;
  }

  base::Status add_images(std::string_view bytes) {
    std::int32_t id = -1;
    if (!take_head(bytes, id) || id < 0) return base::fail("is cut short");
    auto frame = messages::decode<messages::CompressedFrame>(bytes_of(bytes));
    if (!frame) return tl::make_unexpected(frame.error());
    if (const auto images = messages::decompress(*frame); !images) return tl::make_unexpected(images.error());
    images_[egraph::KeyframeId{id}] = *std::move(frame);
    return {};
  }

  base::Status add_planes(std::string_view bytes) {
    std::int32_t id = -1;
    if (!take_head(bytes, id)) return base::fail("is cut short");
    auto frame = messages::decode<features::FrameFeatures>(bytes_of(bytes));
    if (!frame) return tl::make_unexpected(frame.error());
    if (!images_.contains(egraph::KeyframeId{id})) return base::fail("comes before the keyframe's images");
    planes_[egraph::KeyframeId{id}] = *std::move(frame);
    return {};
  }

  base::Status add_poses(std::string_view bytes) {
    const auto poses = messages::decode<tracking::PoseCorrection>(bytes_of(bytes));
    if (!poses) return tl::make_unexpected(poses.error());
    for (const auto& [id, world_from_camera] : poses->entries) {
      KeyframeMap::Keyframe keyframe{world_from_camera, std::nullopt, {}};
      if (const auto images = images_.find(id); images != images_.end()) keyframe.images = std::move(images->second);
      if (const auto planes = planes_.find(id); planes != planes_.end()) keyframe.planes = std::move(planes->second);
      map_.restore(id, std::move(keyframe));
    }
    is_complete_ = true;
    return {};
  }

  KeyframeMap& map_;
  std::map<egraph::KeyframeId, messages::CompressedFrame> images_;
  std::map<egraph::KeyframeId, features::FrameFeatures> planes_;
  bool has_options_ = false;
  bool is_complete_ = false;
};

}  // namespace

base::Status save_dense_archive(const std::filesystem::path& path, const KeyframeMap& map) {
  return io::write_journal(path, schema(), [&](const auto& add_record) -> base::Status {
    const auto add = [&](RecordKind kind, std::string_view bytes) {
      add_record({static_cast<std::uint8_t>(kind), bytes});
    };
    add(RecordKind::options, describe(map.field().options()));
    for (const Eigen::Vector3i& tile : map.field().tiles()) {
      const auto packed = map.field().pack_tile(tile);
      if (!packed) return tl::make_unexpected(packed.error());
      add(RecordKind::tile, with_head(TileNumber{tile.x(), tile.y(), tile.z()}, *packed));
    }
    tracking::PoseCorrection poses;
    for (const auto& [id, keyframe] : map.keyframes()) {
      poses.entries.push_back({id, keyframe.world_from_camera});
      if (!keyframe.images) continue;
      add(RecordKind::images, with_head(id.value, text_of(messages::encode(*keyframe.images))));
      if (keyframe.planes.planes.empty()) continue;
      add(RecordKind::planes, with_head(id.value, text_of(messages::encode(keyframe.planes))));
    }
    add(RecordKind::poses, text_of(messages::encode(poses)));
    return {};
  });
}

base::Status load_dense_archive(const std::filesystem::path& path, KeyframeMap& map) {
  Reader reader(map);
  auto read = io::read_journal(path, schema(), [&](const io::JournalRecord& record) { return reader.add(record); });
  if (read && !reader.is_complete()) return base::fail(path.string() + ": is not complete");
  return read;
}

}  // namespace eg::services
