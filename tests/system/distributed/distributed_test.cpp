#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"
#include "tests/system/distributed/fleet.hpp"

/// All processes, started by procman on machines of their own.
namespace eg {
namespace {

using namespace std::chrono_literals;
using test::file_bytes;
using test::Fleet;

constexpr int kFrames = 15;

class Distributed : public testing::Test {
 protected:
  void TearDown() override { EXPECT_TRUE(test::no_process_is_left()); }

  test::TemporaryFolder folder_;
};

TEST_F(Distributed, TwoAndThreeMachinesFindWhatOneMachineFinds) {
  const auto one = folder_.path() / "one";
  test::Program run("egraph-run", {"--dataset", "synthetic:room", "--frames", std::to_string(kFrames), "--out", one});
  ASSERT_EQ(run.wait(), 0) << run.output();
  const std::vector<Fleet::Options> fleets = {
      {"two_hosts.pmd", {"robot", "base"}, folder_.path() / "two", kFrames},
      {"three_hosts.pmd", {"front", "robot", "base"}, folder_.path() / "three", kFrames}};
  for (const Fleet::Options& options : fleets) {
    const auto hosts = test::Hosts::make(static_cast<int>(options.deputies.size()));
    if (!hosts) GTEST_SKIP() << "this machine does not let the test make machines: " << hosts.error().message;
    Fleet fleet(**hosts, options);
    ASSERT_TRUE(fleet.wait_for_end(240s)) << fleet.output();
    ASSERT_EQ(fleet.stop(), 0) << fleet.output();
    for (const char* name : {"trajectory.txt", "keyframes.txt", "egraph.json", "map.ply", "mesh.ply"}) {
      EXPECT_GT(file_bytes(one / name).size(), 0U) << name;
      EXPECT_TRUE(file_bytes(one / name) == file_bytes(options.out / name))
          << name << " differs with " << options.configuration;
    }
  }
}

}  // namespace
}  // namespace eg
