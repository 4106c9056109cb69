#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "common/egraph/graph.hpp"

namespace eg::services {

/// Which keyframes' points, lines and planes a viewer lacks, because it started late or a message was lost. The tracker
/// has them and sends them again to who asks.
class MissedContents {
 public:
  void note_seen(egraph::KeyframeId keyframe) { seen_.insert(keyframe); }
  void clear() { *this = {}; }

  /// The keyframe that frame `sequence` became, if it is in the graph and was not seen.
  [[nodiscard]] std::optional<egraph::KeyframeId> find(const egraph::Graph& graph, std::int64_t sequence) const;

  /// Some keyframes to ask for now, the newest first; each a few times at most, for nobody may have them any more.
  [[nodiscard]] std::vector<std::int64_t> next(const egraph::Graph& graph);

 private:
  std::set<egraph::KeyframeId> seen_;
  std::map<egraph::KeyframeId, int> asked_;  ///< how often
};

}  // namespace eg::services
