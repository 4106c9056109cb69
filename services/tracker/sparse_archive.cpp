#include "services/tracker/sparse_archive.hpp"

#include <optional>
#include <string>
#include <utility>

#include "common/service/map_archive.hpp"
#include "common/tracking/saved_map.hpp"

namespace eg::services {
namespace {

using service::bytes_of;
using service::text_of;

/// In this order: features and links of each keyframe, then one each of the others.
enum class RecordKind : std::uint8_t { features = 0, links = 1, graph = 2, landmarks = 3 };

std::uint64_t schema() {
  return service::schema_of<features::FrameFeatures, tracking::KeyframeLinks, egraph::GraphSnapshot,
                            tracking::LandmarkPositions>();
}

/// Puts the records together.
class Reader {
 public:
  base::Status add(const io::JournalRecord& record) {
    switch (static_cast<RecordKind>(record.kind)) {
      case RecordKind::features:
        return read<features::FrameFeatures>(record, [this](auto value) {
          saved_.keyframes.push_back({std::move(value), {}});
        });
      case RecordKind::links:
        if (saved_.keyframes.size() != ++links_) return base::fail("belongs to no keyframe");
        return read<tracking::KeyframeLinks>(record,
                                             [this](auto value) { saved_.keyframes.back().links = std::move(value); });
      case RecordKind::graph:
        return read<egraph::GraphSnapshot>(record, [this](auto value) { graph_ = std::move(value); });
      case RecordKind::landmarks:
        return read<tracking::LandmarkPositions>(record, [this](auto value) {
          saved_.landmarks = std::move(value);
          has_landmarks_ = true;
        });
    }
    return base::fail("is of an unknown kind");
  }

  base::Result<SparseArchive> finish() {
    if (!graph_ || !has_landmarks_ || saved_.keyframes.empty() || links_ != saved_.keyframes.size()) {
      return base::fail("is not complete");
    }
    auto map = tracking::rebuild(saved_);
    if (!map) return tl::make_unexpected(map.error());
    SparseArchive archive{*std::move(map), {}};
    if (const auto taken = archive.graph.reset(*graph_); !taken) return tl::make_unexpected(taken.error());
    for (const tracking::MapKeyframe& keyframe : archive.map.keyframes()) {
      if (archive.graph.find_keyframe(keyframe.id) == nullptr) {
        return base::fail("the graph has no keyframe " + std::to_string(keyframe.id.value) +
                          ": the run ended before the E-Graph server had answered it; let that run save again with the "
                          "server running, or take another archive");
      }
    }
    return archive;
  }

 private:
  template <typename Message, typename Take>
  base::Status read(const io::JournalRecord& record, const Take& take) {
    auto message = messages::decode<Message>(bytes_of(record.bytes));
    if (!message) return tl::make_unexpected(message.error());
    take(*std::move(message));
    return {};
  }

  tracking::SavedMap saved_;
  std::size_t links_ = 0;
  std::optional<egraph::GraphSnapshot> graph_;
  bool has_landmarks_ = false;
};

}  // namespace

base::Status save_sparse_archive(const std::filesystem::path& path, const tracking::Map& map,
                                 const egraph::Graph& graph) {
  return io::write_journal(path, schema(), [&](const auto& add_record) -> base::Status {
    const auto add = [&](RecordKind kind, const messages::Bytes& bytes) {
      add_record({static_cast<std::uint8_t>(kind), text_of(bytes)});
    };
    for (const tracking::MapKeyframe& keyframe : map.keyframes()) {
      add(RecordKind::features, messages::encode(keyframe.features));
      add(RecordKind::links, messages::encode(tracking::links_of(keyframe)));
    }
    add(RecordKind::graph, messages::encode(graph.snapshot(0)));
    add(RecordKind::landmarks, messages::encode(tracking::positions_of(map)));
    return {};
  });
}

base::Result<SparseArchive> load_sparse_archive(const std::filesystem::path& path) {
  Reader reader;
  const auto read =
      io::read_journal(path, schema(), [&](const io::JournalRecord& record) { return reader.add(record); });
  if (!read) return tl::make_unexpected(read.error());
  auto archive = reader.finish();
  if (!archive) return base::fail(path.string() + ": " + archive.error().message);
  return archive;
}

}  // namespace eg::services
