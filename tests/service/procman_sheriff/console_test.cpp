#include "services/procman_sheriff/console.hpp"

#include <gtest/gtest.h>

namespace eg::procman_sheriff {
namespace {

TEST(WithName, NamesWhoSpeaksOnce) {
  EXPECT_EQ(with_name("tracker", "map saved"), "[tracker] map saved");
  EXPECT_EQ(with_name("tracker", "[tracker] map saved"), "[tracker] map saved");
  EXPECT_EQ(with_name("red_tracker", "[tracker] map saved"), "[red_tracker] [tracker] map saved");
  EXPECT_EQ(with_name("a", ""), "[a] ");
}

}  // namespace
}  // namespace eg::procman_sheriff
