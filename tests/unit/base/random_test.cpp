#include "common/base/random.hpp"

#include <gtest/gtest.h>

#include <array>

namespace eg::base {
namespace {

TEST(Random, IsTheSplitmix64OfItsAuthors) {
  Random random(1234567);  // first outputs of the authors' program for this seed
  EXPECT_EQ(random.next(), 6457827717110365317ULL);
  EXPECT_EQ(random.next(), 3203168211198807973ULL);
  EXPECT_EQ(random.next(), 9817491932198370423ULL);
}

TEST(Random, UniformHasItsMomentsAndBounds) {
  Random random(1);
  constexpr int kCount = 200000;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    squares += u * u;
  }
  EXPECT_NEAR(sum / kCount, 0.5, 0.003);
  EXPECT_NEAR(squares / kCount, 1.0 / 3.0, 0.003);
  for (int i = 0; i < 1000; ++i) {
    const double x = random.uniform(-2.0, 3.0);
    EXPECT_TRUE(x >= -2.0 && x < 3.0);
  }
}

TEST(Random, NormalHasItsMoments) {
  Random random(2);
  constexpr int kCount = 200000;
  std::array<double, 5> moments{};
  for (int i = 0; i < kCount; ++i) {
    const double x = random.normal();
    ASSERT_TRUE(std::isfinite(x));
    double power = 1.0;
    for (double& moment : moments) {
      moment += power / kCount;
      power *= x;
    }
  }
  EXPECT_NEAR(moments[1], 0.0, 0.01);
  EXPECT_NEAR(moments[2], 1.0, 0.015);
  EXPECT_NEAR(moments[3], 0.0, 0.04);
  EXPECT_NEAR(moments[4], 3.0, 0.1);
}

TEST(Random, IndexReachesEveryValueAboutEqually) {
  Random random(3);
  std::array<int, 7> counts{};
  for (int i = 0; i < 70000; ++i) ++counts[static_cast<std::size_t>(random.index(7))];
  for (const int count : counts) EXPECT_NEAR(count, 10000, 500);
}

}  // namespace
}  // namespace eg::base
