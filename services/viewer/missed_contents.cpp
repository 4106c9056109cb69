#include "services/viewer/missed_contents.hpp"

#include <algorithm>

namespace eg::services {
namespace {

constexpr std::size_t kAtOnce = 4;  // of 130 kB each: what half a second has room for
constexpr int kMostAsked = 5;

}  // namespace

std::optional<egraph::KeyframeId> MissedContents::find(const egraph::Graph& graph, std::int64_t sequence) const {
  const auto nodes = graph.keyframes();
  const auto node = std::find_if(nodes.rbegin(), nodes.rend(), [&](const auto& n) { return n.sequence == sequence; });
  if (node == nodes.rend() || seen_.contains(node->id)) return std::nullopt;
  return node->id;
}

std::vector<std::int64_t> MissedContents::next(const egraph::Graph& graph) {
  std::vector<std::int64_t> wanted;
  const auto nodes = graph.keyframes();
  for (auto node = nodes.rbegin(); node != nodes.rend() && wanted.size() < kAtOnce; ++node) {
    if (seen_.contains(node->id)) continue;
    int& times = asked_[node->id];
    if (times == kMostAsked) continue;
    ++times;
    wanted.push_back(node->id.value);
  }
  return wanted;
}

}  // namespace eg::services
