#include "services/egraph_server/graph_replay.hpp"

#include <utility>

#include "common/egraph/snapshot_parts.hpp"
#include "common/io/journal.hpp"
#include "common/service/message_records.hpp"

namespace eg::services {
namespace {

class Replay {
 public:
  Replay(std::int64_t session, ReplayedGraph& result) : session_(session), result_(result) {}

  base::Status add(const io::JournalRecord& record) {
    const base::Status taken = take(record);
    if (!is_begun_) result_.first_bytes += record.bytes.size();
    return taken;
  }

 private:
  base::Status take(const io::JournalRecord& record) {
    switch (static_cast<RecordKind>(record.kind)) {
      case RecordKind::snapshot_part:
        return take<egraph::GraphSnapshot>(record.bytes);
      case RecordKind::update:
        return take<egraph::GraphUpdate>(record.bytes);
    }
    return base::fail("is of an unknown kind");
  }

  template <typename Message>
  base::Status take(std::string_view bytes) {
    const auto message = messages::decode<Message>(service::bytes_of(bytes));
    if (!message) return tl::make_unexpected(message.error());
    if (message->session == session_) return put(*message);
    return base::fail("belongs to session " + std::to_string(message->session) + ", not " + std::to_string(session_));
  }

  base::Status put(const egraph::GraphSnapshot& part) {
    const auto whole = parts_.add(part);
    return whole ? result_.state.reset(*whole) : base::Status();
  }
  base::Status put(const egraph::GraphUpdate& update) {
    if (update.version > result_.state.graph.version()) {
      is_begun_ = true;
      return result_.state.apply(update);
    }
    result_.state.remember(update);  // behind a snapshot: an answer that led to it and may be asked for again
    return {};
  }

  std::int64_t session_;
  ReplayedGraph& result_;
  egraph::SnapshotAssembler parts_;
  bool is_begun_ = false;  ///< an update has led beyond what the journal was begun with
};

}  // namespace

std::uint64_t journal_schema() { return service::schema_of<egraph::GraphUpdate, egraph::GraphSnapshot>(); }

base::Result<ReplayedGraph> replay_journal(std::string_view bytes, std::int64_t session) {
  auto contents = io::parse_journal(bytes, journal_schema());
  if (!contents) return tl::make_unexpected(contents.error());
  ReplayedGraph result;
  Replay replay(session, result);
  for (std::size_t i = 0; i < contents->records.size(); ++i) {
    if (const auto added = replay.add(contents->records[i]); !added) {
      return base::fail("record " + std::to_string(i) + ": " + added.error().message);
    }
  }
  result.sound_bytes = contents->sound_bytes;
  result.damage = std::move(contents->damage);
  return result;
}

}  // namespace eg::services
