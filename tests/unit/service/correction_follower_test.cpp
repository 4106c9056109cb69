#include "common/service/correction_follower.hpp"

#include <gtest/gtest.h>

namespace eg::service {
namespace {

constexpr std::int64_t kSecond = 1'000'000;

tracking::PoseCorrection correction(std::int64_t since, std::int64_t version) { return {1, version, {}, since}; }

TEST(CorrectionFollower, AsksForNothingWhileNothingIsMissing) {
  CorrectionFollower follower;
  EXPECT_TRUE(follower.has(0));
  EXPECT_TRUE(follower.take(correction(0, 1)));
  EXPECT_TRUE(follower.take(correction(1, 2)));
  EXPECT_FALSE(follower.take(correction(1, 2))) << "it came twice";
  EXPECT_FALSE(follower.to_request(5 * kSecond));
  EXPECT_TRUE(follower.has(2));
}

TEST(CorrectionFollower, AsksFromTheLastCompleteVersionUntilItComes) {
  CorrectionFollower follower;
  EXPECT_FALSE(follower.to_request(10 * kSecond));
  follower.take(correction(0, 1));
  EXPECT_TRUE(follower.take(correction(2, 3))) << "it counts although the one before is missing";
  EXPECT_FALSE(follower.has(2));
  EXPECT_FALSE(follower.to_request(10 * kSecond)) << "perhaps it was only overtaken";
  EXPECT_EQ(follower.to_request(11 * kSecond), 1);
  EXPECT_FALSE(follower.to_request(11 * kSecond + 1));
  EXPECT_EQ(follower.to_request(12 * kSecond), 1);
  EXPECT_TRUE(follower.take(correction(1, 3)));
  EXPECT_TRUE(follower.has(3));
  EXPECT_FALSE(follower.to_request(13 * kSecond));
}

TEST(CorrectionFollower, HearsOfALostOneByThePoses) {
  CorrectionFollower follower;
  follower.announce(2);
  EXPECT_FALSE(follower.to_request(0));
  EXPECT_EQ(follower.to_request(kSecond), 0);
  follower.take(correction(0, 2));
  EXPECT_TRUE(follower.has(2));
}

}  // namespace
}  // namespace eg::service
