#include "common/features/vanishing_linkage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "common/base/random.hpp"

namespace eg::features {
namespace {

PreferenceSet bits(std::initializer_list<int> indices) {
  PreferenceSet set{};
  for (const int i : indices) set[static_cast<std::size_t>(i) / 64] |= std::uint64_t{1} << (i % 64);
  return set;
}

TEST(JLinkage, SeparatesDisjointPreferences) {
  const auto labels = j_linkage({bits({1, 2, 3}), bits({200, 300}), bits({2, 3}), bits({300, 400}), bits({})});
  EXPECT_EQ(labels, (std::vector<int>{0, 1, 0, 1, 2}));
}

TEST(JLinkage, MergesTheNearestFirstAndIntersects) {
  // The middle set touches both others; it goes to the nearer one, and what is left has nothing in common with the
  // third.
  const auto labels = j_linkage({bits({1, 2, 3, 4}), bits({1, 2, 3, 9}), bits({9, 10})});
  EXPECT_EQ(labels, (std::vector<int>{0, 0, 1}));
}

TEST(JLinkage, TakesAnyNumberOfElements) {
  EXPECT_TRUE(j_linkage({}).empty());
  EXPECT_EQ(j_linkage({bits({})}), std::vector<int>{0});
  EXPECT_EQ(j_linkage(std::vector<PreferenceSet>(500, bits({7, 511}))), std::vector<int>(500, 0));
}

TEST(JLinkage, ClustersShareAHypothesisAndCannotBeMergedFurther) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    base::Random random(seed);
    std::vector<PreferenceSet> sets(40, PreferenceSet{});
    for (PreferenceSet& set : sets) {
      const int group = random.index(4);
      for (int i = 0; i < 12; ++i) set[static_cast<std::size_t>(group)] |= std::uint64_t{1} << random.index(20);
      set[static_cast<std::size_t>(random.index(4))] |= std::uint64_t{1} << random.index(64);
    }
    const auto labels = j_linkage(sets);
    const int clusters = *std::max_element(labels.begin(), labels.end()) + 1;
    std::vector<PreferenceSet> common(static_cast<std::size_t>(clusters));
    for (PreferenceSet& set : common) set.fill(~std::uint64_t{0});
    for (std::size_t i = 0; i < sets.size(); ++i) {
      for (std::size_t w = 0; w < sets[i].size(); ++w) common[static_cast<std::size_t>(labels[i])][w] &= sets[i][w];
    }
    const auto intersects = [](const PreferenceSet& a, const PreferenceSet& b) {
      for (std::size_t w = 0; w < a.size(); ++w) {
        if ((a[w] & b[w]) != 0) return true;
      }
      return false;
    };
    for (std::size_t a = 0; a < common.size(); ++a) {
      EXPECT_TRUE(intersects(common[a], common[a]));
      for (std::size_t b = a + 1; b < common.size(); ++b) EXPECT_FALSE(intersects(common[a], common[b]));
    }
  }
}

}  // namespace
}  // namespace eg::features
