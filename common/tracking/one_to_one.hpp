#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "common/tracking/map.hpp"

namespace eg::tracking {

/// Keeps, of all matches of one feature, the one with the smallest distance.
template <typename Id>
class OneToOne {
 public:
  explicit OneToOne(std::size_t features) : best_(features) {}

  void offer(std::int32_t feature, Id id, double distance) {
    auto& best = best_[static_cast<std::size_t>(feature)];
    if (!best.second.valid() || distance < best.first) best = {distance, id};
  }
  [[nodiscard]] std::vector<Match<Id>> matches() const {
    std::vector<Match<Id>> matches;
    for (std::size_t i = 0; i < best_.size(); ++i) {
      if (best_[i].second.valid()) matches.push_back({static_cast<std::int32_t>(i), best_[i].second});
    }
    return matches;
  }

 private:
  std::vector<std::pair<double, Id>> best_;
};

/// Features by track id, for feature-level data with known correspondences.
template <typename Features>
std::map<std::int32_t, std::int32_t> index_by_track(const Features& features) {
  std::map<std::int32_t, std::int32_t> index;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (features[i].track_id >= 0) index[features[i].track_id] = static_cast<std::int32_t>(i);
  }
  return index;
}

}  // namespace eg::tracking
