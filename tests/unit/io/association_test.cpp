#include "common/io/association.hpp"

#include <gtest/gtest.h>

#include <set>

#include "common/base/random.hpp"

namespace eg::io {
namespace {

using Times = std::vector<std::int64_t>;

std::vector<std::pair<int, int>> pairs_of(const Times& colour, const Times& depth, std::int64_t tolerance = 20) {
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [c, d] : associate(colour, depth, tolerance)) pairs.emplace_back(c, d);
  return pairs;
}

using Pairs = std::vector<std::pair<int, int>>;

TEST(Associate, NothingToPair) {
  EXPECT_EQ(pairs_of({}, {}), Pairs{});
  EXPECT_EQ(pairs_of({1}, {}), Pairs{});
  EXPECT_EQ(pairs_of({}, {1}), Pairs{});
  EXPECT_EQ(pairs_of({0}, {21}), Pairs{});
}

TEST(Associate, TheClosestPairWinsAndTheOtherFindsItsNextBest) {
  // Depth 10 is nearest to both colours; colour 12 is nearer and gets it, colour 0 falls back to depth -15.
  EXPECT_EQ(pairs_of({0, 12}, {-15, 10}), (Pairs{{0, 0}, {1, 1}}));
  // Without the fallback colour 0 stays alone.
  EXPECT_EQ(pairs_of({0, 12}, {10}), (Pairs{{1, 0}}));
}

TEST(Associate, OfEquallyCloseTheEarlierWins) {
  EXPECT_EQ(pairs_of({10}, {5, 15}), (Pairs{{0, 0}}));
  EXPECT_EQ(pairs_of({5, 15}, {10}), (Pairs{{0, 0}}));
}

TEST(Associate, PairsDoNotCross) {
  // After colour 5 and depth 6 have found each other, colour 10 and depth 0 would have to cross them.
  EXPECT_EQ(pairs_of({5, 10}, {0, 6}), (Pairs{{0, 1}}));
}

TEST(Associate, RandomSeriesKeepAllPromises) {
  base::Random random(7);
  for (int round = 0; round < 200; ++round) {
    std::set<std::int64_t> colour, depth;
    for (int i = 0; i < 30; ++i) {
      colour.insert(random.index(1000));
      depth.insert(random.index(1000));
    }
    const Times colour_times(colour.begin(), colour.end()), depth_times(depth.begin(), depth.end());
    const auto pairs = associate(colour_times, depth_times, 20);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      EXPECT_LE(std::abs(colour_times[pairs[i].colour] - depth_times[pairs[i].depth]), 20);
      if (i == 0) continue;
      EXPECT_LT(pairs[i - 1].colour, pairs[i].colour);
      EXPECT_LT(pairs[i - 1].depth, pairs[i].depth);
    }
  }
}

}  // namespace
}  // namespace eg::io
