#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/temporary_folder.hpp"
#include "tests/system/distributed/fleet.hpp"

/// Services that are killed amidst a run, and started again by their deputy.
namespace eg {
namespace {

using namespace std::chrono_literals;
using test::file_bytes;
using test::Fleet;

constexpr int kFrames = 12;

class Killed : public testing::TestWithParam<const char*> {
 protected:
  void TearDown() override { EXPECT_TRUE(test::no_process_is_left()); }

  test::TemporaryFolder folder_;
};

TEST_P(Killed, TheRunIsCompletedAllTheSame) {
  const auto hosts = test::Hosts::make(2);
  if (!hosts) GTEST_SKIP() << "this machine does not let the test make machines: " << hosts.error().message;
  Fleet fleet(**hosts, {"two_hosts.pmd", {"robot", "base"}, folder_.path(), kFrames});
  ASSERT_TRUE(fleet.wait_for_poses(3, 100s)) << fleet.output();
  ASSERT_TRUE(fleet.kill_service(GetParam())) << fleet.output();
  ASSERT_TRUE(fleet.wait_for_end(60s)) << fleet.output();
  ASSERT_EQ(fleet.stop(), 0) << fleet.output();
  const std::string trajectory = file_bytes(folder_.path() / "trajectory.txt");
  EXPECT_EQ(std::count(trajectory.begin(), trajectory.end(), '\n'), kFrames + 1)
      << "with a heading; " << fleet.output();
}

INSTANTIATE_TEST_SUITE_P(All, Killed,
                         testing::Values("egraph-frame-source", "egraph-feature-extractor", "egraph-server",
                                         "egraph-tracker", "egraph-mapper"));

}  // namespace
}  // namespace eg
