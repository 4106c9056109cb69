#include "common/io/association.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>

namespace eg::io {
namespace {

struct Candidate {
  ImagePair pair;
  std::int64_t difference;
};

/// Every pair within the tolerance, in increasing time. The window over the depth images only moves forward.
std::vector<Candidate> candidates_within(std::span<const std::int64_t> colour_utimes,
                                         std::span<const std::int64_t> depth_utimes, std::int64_t max_difference) {
  std::vector<Candidate> candidates;
  std::size_t window = 0;
  for (std::size_t i = 0; i < colour_utimes.size(); ++i) {
    while (window < depth_utimes.size() && depth_utimes[window] < colour_utimes[i] - max_difference) ++window;
    for (std::size_t j = window; j < depth_utimes.size() && depth_utimes[j] <= colour_utimes[i] + max_difference; ++j) {
      candidates.push_back({{i, j}, std::abs(colour_utimes[i] - depth_utimes[j])});
    }
  }
  return candidates;
}

/// Whether depth image `depth` lies strictly between the partners of the neighbours of `next`.
bool keeps_order(const std::map<std::size_t, std::size_t>& depth_of_colour,
                 std::map<std::size_t, std::size_t>::const_iterator next, std::size_t depth) {
  if (next != depth_of_colour.end() && next->second <= depth) return false;
  return next == depth_of_colour.begin() || std::prev(next)->second < depth;
}

}  // namespace

std::vector<ImagePair> associate(std::span<const std::int64_t> colour_utimes,
                                 std::span<const std::int64_t> depth_utimes, std::int64_t max_difference) {
  std::vector<Candidate> candidates = candidates_within(colour_utimes, depth_utimes, max_difference);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.difference < b.difference; });

  std::map<std::size_t, std::size_t> depth_of_colour;
  for (const auto& [pair, difference] : candidates) {
    const auto next = depth_of_colour.lower_bound(pair.colour);
    const bool taken = next != depth_of_colour.end() && next->first == pair.colour;
    if (!taken && keeps_order(depth_of_colour, next, pair.depth)) depth_of_colour.emplace(pair.colour, pair.depth);
  }

  std::vector<ImagePair> pairs;
  for (const auto& [colour, depth] : depth_of_colour) pairs.push_back({colour, depth});
  return pairs;
}

}  // namespace eg::io
