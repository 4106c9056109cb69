#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <map>
#include <set>

#include "common/messages/channels.hpp"
#include "common/transport/lcm_bus.hpp"
#include "tests/support/private_network.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

/// Two robots at one E-Graph server: one on the server's bus, the other on a bus of its own behind a relay.
namespace eg {
namespace {

using namespace std::chrono_literals;
using test::file_bytes;
using test::Program;
using Arguments = std::vector<std::string>;

constexpr char kUrl[] = "udpm://239.255.76.67:7994?ttl=0&recv_buf_size=2097152";
constexpr char kOwnUrl[] = "udpm://239.255.76.67:7990?ttl=0&recv_buf_size=2097152";  // of the robot behind a relay
constexpr char kFrames[] = "60";
const std::map<std::string, std::string> kSeeds = {{"red_", "1"}, {"blue_", "2"}};  // of what each robot sees

class Robots : public testing::Test {
 protected:
  void SetUp() override {
    const std::string why = test::enter_private_network(true);
    if (!why.empty()) GTEST_SKIP() << "this machine does not let the test make a network: " << why;
  }
  void TearDown() override { EXPECT_TRUE(test::no_process_is_left()); }

  std::string out(const std::string& name) { return (folder_.path() / name).string(); }
  std::string config(const std::string& robot) {
    return folder_.write(robot + ".yaml", "frame_source:\n  synthetic:\n    seed: " + kSeeds.at(robot) + "\n").string();
  }
  void start(const std::string& name, const Arguments& arguments) {
    programs_.push_back(std::make_unique<Program>(name, arguments));
  }
  /// Tracker and source. `bus`: where they are to be found.
  void start_robot(const std::string& name, const Arguments& bus) {
    Arguments tracker = {"--lockstep", "--out", out(name), "--config", config(name)};
    tracker.insert(tracker.end(), bus.begin(), bus.end());
    Arguments source = tracker;
    source.insert(source.end(), {"--observations", "synthetic:walk", "--frames", kFrames, "--consumers", "tracker"});
    start("egraph-tracker", tracker);
    start("egraph-frame-source", source);
  }
  /// Waits until the sources of all robots have announced the end.
  static bool wait_for_the_end(transport::LcmBus& bus, const std::set<std::string>& ended) {
    const auto limit = std::chrono::steady_clock::now() + 120s;
    while (ended.size() < kSeeds.size() && std::chrono::steady_clock::now() < limit) {
      if (!bus.handle(100ms)) return false;
    }
    return ended.size() == kSeeds.size();
  }

  test::TemporaryFolder folder_;
  std::vector<std::unique_ptr<Program>> programs_;
};

TEST_F(Robots, HaveAtOneServerWhatEachHasAlone) {
  for (const auto& [robot, seed] : kSeeds) {
    Program alone("egraph-run", {"--observations", "synthetic:walk", "--frames", kFrames, "--config", config(robot),
                                 "--out", out(robot + "alone")});
    ASSERT_EQ(alone.wait(), 0) << alone.output();
  }
  const auto bus = transport::LcmBus::create({kUrl, ""});
  ASSERT_TRUE(bus) << bus.error().message;
  std::set<std::string> ended;
  for (const auto& [robot, seed] : kSeeds) {
    const auto note = [&ended](const transport::ReceivedMessage& message) { ended.emplace(message.channel); };
    ASSERT_TRUE((*bus)->subscribe(robot + messages::channels::kEndOfStream, note, 1));
  }
  start("egraph-server", {"--lcm-url", kUrl, "--lockstep", "--robots", "red_,blue_", "--out", out("base")});
  start_robot("red_", {"--lcm-url", kUrl, "--channel-prefix", "red_"});
  start("egraph-relay", {"--lcm-url", kOwnUrl, "--shared-url", kUrl, "--shared-prefix", "blue_"});
  start_robot("blue_", {"--lcm-url", kOwnUrl});
  ASSERT_TRUE(wait_for_the_end(**bus, ended)) << programs_.front()->output();
  for (const auto& program : programs_) program->send_signal(SIGINT);
  for (const auto& program : programs_) EXPECT_EQ(program->wait(), 0) << program->output();

  for (const auto& [robot, seed] : kSeeds) {
    for (const char* name : {"trajectory.txt", "keyframes.txt"}) {
      EXPECT_GT(file_bytes(folder_.path() / robot / name).size(), 0U) << robot << name;
      EXPECT_TRUE(file_bytes(folder_.path() / robot / name) == file_bytes(folder_.path() / (robot + "alone") / name))
          << robot << name;
    }
    const std::string graph = file_bytes(folder_.path() / "base" / robot / "egraph.json");
    EXPECT_GT(graph.size(), 0U);
    EXPECT_TRUE(graph == file_bytes(folder_.path() / (robot + "alone") / "egraph.json")) << robot;
  }
  EXPECT_NE(file_bytes(folder_.path() / "base/red_/egraph.json"),
            file_bytes(folder_.path() / "base/blue_/egraph.json"));
}

}  // namespace
}  // namespace eg
