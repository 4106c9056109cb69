#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/egraph/graph_builder.hpp"
#include "common/io/journal.hpp"

namespace eg::services {

/// What was kept of a session.
struct StoredGraph {
  egraph::BuilderState state;
  std::string warning;  ///< what was lost and where it was put aside; empty: nothing
};

/// How journals are kept short.
struct GraphStoreOptions {
  /// Bytes: a longer journal is rewritten if it is also a multiple of what it was when it was begun.
  std::size_t compaction_bytes = std::size_t{16} << 20U;
};

/// One session's graph on disk, graph-<session>.journal: a snapshot, the answers that led to it and the updates since,
/// as the messages that carry them. Every update is on the disk before it is sent, so that a server that was killed
/// comes back with everything it has ever answered.
class GraphStore {
 public:
  /// Makes the folder unless it is there, or its name is empty. Refuses journals in it that this program cannot read,
  /// by name, before any session needs them.
  static base::Status prepare_folder(const std::filesystem::path& folder);

  /// The sessions that are kept in a folder, in ascending order.
  static std::vector<std::int64_t> sessions_in(const std::filesystem::path& folder);

  GraphStore(const std::filesystem::path& folder, std::int64_t session, const GraphStoreOptions& options = {});

  [[nodiscard]] bool exists() const { return std::filesystem::exists(path_); }

  /// The graph as it was; an empty one if nothing was kept. A damaged end (a write cut short, bits turned over) is put
  /// aside as graph-<session>.journal.damaged, and the graph is as the last sound record left it. Refuses a journal of
  /// another version, another session's, and one that contradicts itself.
  base::Result<StoredGraph> load();

  /// Keeps an update and with it the state of `builder`, which it has led to; one that is kept already is ignored. Now
  /// and then the journal is rewritten as a snapshot, so that its length stays in proportion to the graph.
  base::Status append(const egraph::GraphUpdate& update, const egraph::GraphBuilder& builder);

  /// Keeps a graph, and the answers that led to it, in the place of whatever is kept.
  base::Status replace(const egraph::Graph& graph, const std::deque<egraph::GraphUpdate>& recent = {});

 private:
  /// A new journal in the place of whatever is there.
  base::Status begin(std::span<const io::JournalRecord> records);
  /// `first_bytes`: of the journal when it was begun.
  void go_on_with(io::Journal journal, std::size_t first_bytes);

  std::filesystem::path path_;
  std::int64_t session_;
  GraphStoreOptions options_;
  std::optional<io::Journal> journal_;
  std::int64_t version_ = 0;    ///< of the graph that is kept
  std::size_t compact_at_ = 0;  ///< bytes of the journal
};

}  // namespace eg::services
