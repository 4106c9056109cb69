#include <gtest/gtest.h>

#include <unordered_set>

#include "common/base/check.hpp"
#include "common/base/id.hpp"
#include "common/base/printable.hpp"
#include "common/base/result.hpp"

namespace eg::base {
namespace {

struct TestTag;
using TestId = Id<TestTag>;

TEST(Id, IsInvalidUntilItHasAValue) {
  EXPECT_FALSE(TestId{}.valid());
  EXPECT_TRUE(TestId{0}.valid());
  EXPECT_LT(TestId{1}, TestId{2});
  EXPECT_EQ(TestId{3}, TestId{3});
}

TEST(Id, CanBeHashed) {
  const std::unordered_set<TestId> ids = {TestId{1}, TestId{2}, TestId{1}};
  EXPECT_EQ(ids.size(), 2U);
}

TEST(Printable, LeavesTheTerminalAlone) {
  EXPECT_EQ(printable("a\x1b[2Jb\tc\x7f\n"), "a [2Jb\tc  ");
  EXPECT_EQ(printable("a\u009b2J"), "a 2J") << "xterm and others obey the control characters of U+0080 and up";
  EXPECT_EQ(printable("Küche \u00a0\xc2"), "Küche \u00a0\xc2");
  EXPECT_EQ(control_bytes_at("a\u0085", 0), 0U);
  EXPECT_EQ(control_bytes_at("a\u0085", 1), 2U);
}

TEST(Result, HoldsAValueOrAReason) {
  const auto half = [](int x) -> Result<int> {
    if (x % 2 != 0) return fail("number " + std::to_string(x) + " is odd");
    return x / 2;
  };
  EXPECT_EQ(*half(6), 3);
  ASSERT_FALSE(half(7).has_value());
  EXPECT_EQ(half(7).error().message, "number 7 is odd");
  EXPECT_TRUE(Status{}.has_value());
}

TEST(CheckDeathTest, EndsTheProcessAndSaysWhere) {
  EG_CHECK(1 + 1 == 2, "arithmetic holds");
  EXPECT_DEATH(EG_CHECK(1 + 1 == 3, "arithmetic fails"),
               "base_test.cpp:[0-9]+: check failed: 1 \\+ 1 == 3 .arithmetic fails");
}

}  // namespace
}  // namespace eg::base
