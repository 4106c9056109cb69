#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "common/egraph/types.hpp"

namespace eg::egraph {

/// Cuts a snapshot into parts of at most about `max_bytes` when encoded, so that each fits into a datagram that kernels
/// do not drop. There is always at least one.
std::vector<GraphSnapshot> split(const GraphSnapshot& snapshot, std::size_t max_bytes = 120'000);

/// Puts the parts of a snapshot together, in whatever order and however often they come. One session at a time; parts
/// of a newer version displace those of an older one. What comes to more than half a gigabyte is given up.
class SnapshotAssembler {
 public:
  /// The whole snapshot, when `part` was the last one missing.
  std::optional<GraphSnapshot> add(const GraphSnapshot& part);

 private:
  void clear();

  std::map<std::int32_t, GraphSnapshot> parts_;  ///< of one version, by number
  std::size_t bytes_ = 0;                        ///< of them, about
};

}  // namespace eg::egraph
