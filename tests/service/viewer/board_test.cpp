#include "services/viewer/board.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <map>

namespace eg::services {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// What a browser that asks for everything after `stamp` is sent, and the stamp that it then has.
std::vector<Bytes> read_on(const Board& board, std::uint64_t& stamp) {
  std::vector<Bytes> packets;
  while (const auto item = board.next(stamp)) {
    stamp = item->stamp;
    packets.push_back(*item->bytes);
  }
  return packets;
}

TEST(Board, GivesALateBrowserTheNewestOfEveryKeyInTheOrderOfTheirChanges) {
  Board board(1000);
  EXPECT_TRUE(board.put("a", {1}));
  EXPECT_TRUE(board.put("b", {2}));
  EXPECT_TRUE(board.put("a", {3}));
  std::uint64_t stamp = 0;
  EXPECT_EQ(read_on(board, stamp), (std::vector<Bytes>{{2}, {3}}));
}

TEST(Board, GivesASlowBrowserTheNewestOnly) {
  Board board(1000);
  board.put("pose", {0});
  std::uint64_t stamp = 0;
  EXPECT_EQ(read_on(board, stamp).size(), 1u);
  for (std::uint8_t i = 1; i < 100; ++i) board.put("pose", {i});
  EXPECT_EQ(read_on(board, stamp), std::vector<Bytes>{{99}});
}

TEST(Board, SendsNothingAgainThatHasNotChanged) {
  Board board(1000);
  board.put("a", {1, 2});
  std::uint64_t stamp = 0;
  read_on(board, stamp);
  EXPECT_TRUE(board.put("a", {1, 2}));
  EXPECT_TRUE(read_on(board, stamp).empty());
}

TEST(Board, RefusesWhatDoesNotFitAndKeepsWhatItHas) {
  Board board(10);
  EXPECT_TRUE(board.put("a", Bytes(6)));
  EXPECT_FALSE(board.put("b", Bytes(5)));
  EXPECT_FALSE(board.put("a", Bytes(11)));
  EXPECT_TRUE(board.put("a", Bytes(10)));
  EXPECT_EQ(board.bytes(), 10u);
}

TEST(Board, TellsBrowsersOfANewBeginningFirst) {
  Board board(1000);
  board.put("a", {1});
  std::uint64_t stamp = 0;
  read_on(board, stamp);
  board.restart("scene", {7});
  board.put("a", {2});
  EXPECT_EQ(read_on(board, stamp), (std::vector<Bytes>{{7}, {2}}));
  EXPECT_EQ(board.bytes(), 2u);
}

// Whoever reads whenever ends up with the same as somebody who comes at the end.
RC_GTEST_PROP(Board, EveryBrowserEndsUpWithTheSame, ()) {
  Board board(100'000);
  std::uint64_t stamp = 0;
  std::map<std::uint8_t, Bytes> seen;  // by key, which is the first byte
  const auto take = [&](std::uint64_t& from, std::map<std::uint8_t, Bytes>& into) {
    for (const Bytes& packet : read_on(board, from)) into[packet[0]] = packet;
  };
  const auto steps = *rc::gen::container<std::vector<std::tuple<std::uint8_t, std::uint8_t, bool>>>(rc::gen::tuple(
      rc::gen::inRange<std::uint8_t>(0, 8), rc::gen::arbitrary<std::uint8_t>(), rc::gen::arbitrary<bool>()));
  for (const auto& [key, value, reads] : steps) {
    board.put(std::to_string(key), {key, value});
    if (reads) take(stamp, seen);
  }
  take(stamp, seen);
  std::uint64_t late_stamp = 0;
  std::map<std::uint8_t, Bytes> late;
  take(late_stamp, late);
  RC_ASSERT(seen == late);
}

}  // namespace
}  // namespace eg::services
