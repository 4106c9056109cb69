#include "common/features/vanishing_linkage.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <utility>

namespace eg::features {
namespace {

/// Bits set in both sets. Counts all words' bytes side by side and adds them up once: without a processor's own
/// instruction, which a portable build must not use, this is twice as fast as word by word.
int count_common(const PreferenceSet& a, const PreferenceSet& b) {
  static_assert(8 * std::tuple_size_v<PreferenceSet> < 256, "a byte holds the sum over all words");
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::uint64_t word = a[i] & b[i];
    word -= (word >> 1) & 0x5555555555555555ULL;
    word = (word & 0x3333333333333333ULL) + ((word >> 2) & 0x3333333333333333ULL);
    bytes += (word + (word >> 4)) & 0x0f0f0f0f0f0f0f0fULL;
  }
  constexpr std::uint64_t kPairs = 0x00ff00ff00ff00ffULL;
  const std::uint64_t pairs = (bytes & kPairs) + ((bytes >> 8) & kPairs);
  return static_cast<int>((pairs * 0x0001000100010001ULL) >> 48);
}

/// Similarity 1 - Jaccard distance, |A ∩ B| / |A ∪ B|, kept as a fraction so that comparisons are exact.
struct Similarity {
  int common = 0;
  int all = 1;

  friend bool operator>(const Similarity& a, const Similarity& b) { return a.common * b.all > b.common * a.all; }
};

/// The nearest later cluster of a cluster.
struct Neighbour {
  std::size_t index = 0;
  Similarity similarity;
};

class Linkage {
 public:
  explicit Linkage(std::vector<PreferenceSet> sets)
      : sets_(std::move(sets)),
        sizes_(sets_.size()),
        cluster_of_(sets_.size()),
        alive_(sets_.size()),
        nearest_(sets_.size()) {
    std::iota(cluster_of_.begin(), cluster_of_.end(), std::size_t{0});
    std::iota(alive_.begin(), alive_.end(), std::size_t{0});
    for (std::size_t i = 0; i < sets_.size(); ++i) sizes_[i] = count_common(sets_[i], sets_[i]);
    for (std::size_t position = 0; position < alive_.size(); ++position) find_nearest(position);
  }

  std::vector<int> run() {
    while (merge_closest()) {
    }
    std::vector<int> labels(sets_.size());
    std::vector<int> label_of_cluster(sets_.size(), -1);
    int clusters = 0;
    for (std::size_t i = 0; i < sets_.size(); ++i) {
      int& label = label_of_cluster[root(i)];
      if (label < 0) label = clusters++;
      labels[i] = label;
    }
    return labels;
  }

 private:
  [[nodiscard]] Similarity similarity(std::size_t a, std::size_t b) const {
    const int common = count_common(sets_[a], sets_[b]);
    const int all = sizes_[a] + sizes_[b] - common;
    return {common, all > 0 ? all : 1};
  }

  void find_nearest(std::size_t position) {
    const std::size_t a = alive_[position];
    nearest_[a] = {a, {}};
    for (std::size_t later = position + 1; later < alive_.size(); ++later) consider(a, alive_[later]);
  }

  void consider(std::size_t a, std::size_t b) {
    const Similarity candidate = similarity(a, b);
    if (candidate > nearest_[a].similarity) nearest_[a] = {b, candidate};
  }

  /// False if no two clusters have a hypothesis in common.
  bool merge_closest() {
    std::size_t best = 0;
    Similarity best_similarity;
    for (const std::size_t a : alive_) {
      if (!(nearest_[a].similarity > best_similarity)) continue;
      best = a;
      best_similarity = nearest_[a].similarity;
    }
    if (best_similarity.common == 0) return false;
    merge(best, nearest_[best].index);
    return true;
  }

  void merge(std::size_t kept, std::size_t gone) {
    for (std::size_t word = 0; word < sets_[kept].size(); ++word) sets_[kept][word] &= sets_[gone][word];
    sizes_[kept] = count_common(sets_[kept], sets_[kept]);
    cluster_of_[gone] = kept;
    std::erase(alive_, gone);
    for (std::size_t position = 0; position < alive_.size(); ++position) {
      const std::size_t a = alive_[position];
      const bool stale = a == kept || nearest_[a].index == kept || nearest_[a].index == gone;
      if (stale) {
        find_nearest(position);
      } else if (a < kept) {
        consider(a, kept);
      }
    }
  }

  [[nodiscard]] std::size_t root(std::size_t element) const {
    while (cluster_of_[element] != element) element = cluster_of_[element];
    return element;
  }

  std::vector<PreferenceSet> sets_;
  std::vector<int> sizes_;
  std::vector<std::size_t> cluster_of_;
  std::vector<std::size_t> alive_;  // sorted
  std::vector<Neighbour> nearest_;  // a neighbour that is the cluster itself: none
};

}  // namespace

std::vector<int> j_linkage(std::vector<PreferenceSet> sets) { return Linkage(std::move(sets)).run(); }

}  // namespace eg::features
