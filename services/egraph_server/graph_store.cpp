#include "services/egraph_server/graph_store.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "common/egraph/snapshot_parts.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/text_file.hpp"
#include "common/messages/codec.hpp"
#include "common/service/message_records.hpp"
#include "services/egraph_server/graph_replay.hpp"

namespace eg::services {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "graph-";
constexpr std::string_view kExtension = ".journal";

/// Updates repeat landmarks: a journal that has grown to this multiple of its first length is rewritten as a snapshot.
constexpr std::size_t kCompactionFactor = 4;

tl::unexpected<base::Error> about(const fs::path& path, const std::string& what) {
  return base::fail(path.string() + ": " + what);
}

/// Copies a journal with a damaged end, for a person to look at. Returns what to tell that person.
std::string put_aside(const fs::path& path, const std::string& damage) {
  fs::path copy = path;
  copy += ".damaged";
  std::error_code failure;
  fs::copy_file(path, copy, fs::copy_options::overwrite_existing, failure);
  const std::string where = failure ? "no copy could be kept: " + failure.message() : "a copy is in " + copy.string();
  return path.string() + ": " + damage + ", the graph goes on from the record before; " + where;
}

}  // namespace

GraphStore::GraphStore(const fs::path& folder, std::int64_t session, const GraphStoreOptions& options)
    : path_(folder / (std::string(kPrefix) + std::to_string(session) + std::string(kExtension))),
      session_(session),
      options_(options) {}

std::vector<std::int64_t> GraphStore::sessions_in(const fs::path& folder) {
  std::vector<std::int64_t> sessions;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPrefix) || !name.ends_with(kExtension)) continue;
    const char* const end = name.data() + name.size() - kExtension.size();
    std::int64_t session = 0;
    const auto number = std::from_chars(name.data() + kPrefix.size(), end, session);
    if (number.ec == std::errc{} && number.ptr == end) sessions.push_back(session);
  }
  std::sort(sessions.begin(), sessions.end());
  return sessions;
}

base::Status GraphStore::prepare_folder(const fs::path& folder) {
  if (folder.empty()) return {};
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) return about(folder, "cannot be made: " + failure.message());
  if (const auto writable = io::check_writable(folder); !writable) return writable;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPrefix) || !name.ends_with(kExtension)) continue;
    if (const auto sound = io::check_journal(entry.path(), journal_schema()); !sound) return sound;
  }
  if (failure) return about(folder, "cannot be read: " + failure.message());
  return {};
}

base::Result<StoredGraph> GraphStore::load() {
  if (!fs::exists(path_)) return StoredGraph{};
  const auto bytes = io::read_file(path_);
  if (!bytes) return tl::make_unexpected(bytes.error());
  auto replayed = replay_journal(*bytes, session_);
  if (!replayed) return about(path_, replayed.error().message);
  StoredGraph stored{std::move(replayed->state), ""};
  if (!replayed->damage.empty()) stored.warning = put_aside(path_, replayed->damage);
  auto journal = io::Journal::open(path_, replayed->sound_bytes);
  if (!journal) return tl::make_unexpected(journal.error());
  go_on_with(std::move(*journal), replayed->first_bytes);
  version_ = stored.state.graph.version();
  return stored;
}

base::Status GraphStore::append(const egraph::GraphUpdate& update, const egraph::GraphBuilder& builder) {
  if (update.version <= version_) return {};
  const bool follows = update.base_version == version_;
  if (!journal_ && follows) {
    if (const auto begun = begin({}); !begun) return begun;
  }
  if (!follows || journal_->size() > compact_at_) return replace(builder.graph(), builder.recent_updates());
  const messages::Bytes bytes = messages::encode(update);
  const auto written = journal_->append({static_cast<std::uint8_t>(RecordKind::update), service::text_of(bytes)});
  if (!written) return written;
  version_ = update.version;
  return {};
}

base::Status GraphStore::replace(const egraph::Graph& graph, const std::deque<egraph::GraphUpdate>& recent) {
  std::deque<messages::Bytes> messages;  // stay where they are: the records point into them
  std::vector<io::JournalRecord> records;
  const auto add = [&](RecordKind kind, messages::Bytes message) {
    records.push_back({static_cast<std::uint8_t>(kind), service::text_of(messages.emplace_back(std::move(message)))});
  };
  for (const egraph::GraphSnapshot& part : egraph::split(graph.snapshot(session_))) {
    add(RecordKind::snapshot_part, messages::encode(part));
  }
  for (const egraph::GraphUpdate& update : recent) add(RecordKind::update, messages::encode(update));
  if (const auto written = begin(records); !written) return written;
  version_ = graph.version();
  return {};
}

base::Status GraphStore::begin(std::span<const io::JournalRecord> records) {
  auto journal = io::Journal::create(path_, journal_schema(), records);
  if (!journal) return tl::make_unexpected(journal.error());
  const std::size_t first_bytes = journal->size();
  go_on_with(std::move(*journal), first_bytes);
  return {};
}

void GraphStore::go_on_with(io::Journal journal, std::size_t first_bytes) {
  journal_ = std::move(journal);
  compact_at_ = std::max(options_.compaction_bytes, kCompactionFactor * first_bytes);
}

}  // namespace eg::services
