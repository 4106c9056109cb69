#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/result.hpp"
#include "common/egraph/graph_builder.hpp"
#include "common/messages/codec.hpp"

namespace eg::services {

/// The kinds of records in a graph's journal: messages as they are sent.
enum class RecordKind : std::uint8_t {
  snapshot_part = 0,
  update = 1,
};

/// Stands for the message types in the header of a journal.
std::uint64_t journal_schema();

/// What the bytes of a journal say.
struct ReplayedGraph {
  egraph::BuilderState state;
  std::size_t sound_bytes = 0;  ///< of the journal, up to its end or the first damage
  std::size_t first_bytes = 0;  ///< of it, what it was begun with: a snapshot and the answers that led there
  std::string damage;           ///< in a few words; empty: none
};

/// Rebuilds the graph of `session`. A damaged record ends it. Refuses what is no journal of this version, what belongs
/// to another session, and what contradicts itself.
base::Result<ReplayedGraph> replay_journal(std::string_view bytes, std::int64_t session);

}  // namespace eg::services
