#include "services/run/run_monitor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/messages/channels.hpp"
#include "common/transport/memory_bus.hpp"
#include "services/run/save_request.hpp"

namespace eg::run {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
namespace channels = messages::channels;

class RunTest : public testing::Test {
 protected:
  RunMonitor make_monitor(bool lockstep) {
    RunMonitor::Options options;
    options.lockstep = lockstep;
    options.consumers = {"mapper", "tracker"};
    return RunMonitor(context_, options, now_);
  }
  void deliver(RunMonitor& monitor, std::chrono::milliseconds later = 0ms) {
    now_ += later;
    monitor.update(now_);
    ASSERT_TRUE(bus_.handle(0ms));
  }
  void acknowledge(const std::string& consumer, std::int64_t sequence) {
    peer_.publish(channels::kAcknowledge, messages::Acknowledge{1, sequence, consumer});
  }
  void end_stream(std::int64_t frames, std::vector<std::int64_t> skipped = {}) {
    peer_.publish(channels::kEndOfStream, messages::EndOfStream{1, frames, std::move(skipped)});
  }
  void send_pose(std::int64_t sequence, bool has_pose = true) {
    tracking::PoseEstimate pose;
    pose.header = {1, sequence, 1000 * (sequence + 1)};
    pose.state = has_pose ? tracking::TrackingState::tracking : tracking::TrackingState::lost;
    pose.has_pose = has_pose;
    peer_.publish(channels::kPose, pose);
  }
  void send_status(const std::string& service) {
    messages::ServiceStatus status;
    status.service = service;
    status.state = "running";
    peer_.publish(channels::kStatus, status);
  }

  std::shared_ptr<transport::MemoryNetwork> network_ = std::make_shared<transport::MemoryNetwork>();
  transport::MemoryBus bus_{network_};
  transport::MemoryBus peer_bus_{network_};
  service::ServiceContext context_{bus_, {}};
  service::ServiceContext peer_{peer_bus_, {}};
  Clock::time_point now_;
};

TEST_F(RunTest, LockstepIsOverWhenAllConsumersAreDoneWithAllFrames) {
  RunMonitor monitor = make_monitor(true);
  acknowledge("tracker", 2);
  acknowledge("mapper", 1);
  end_stream(3, {77});
  deliver(monitor);
  EXPECT_EQ(monitor.frames_done(), 2);
  EXPECT_EQ(monitor.frames_skipped(), 1);
  EXPECT_FALSE(monitor.finished());
  acknowledge("mapper", 2);
  deliver(monitor);
  EXPECT_TRUE(monitor.finished());
}

TEST_F(RunTest, WaitsForEachOfTheMappersThatShareTheSpace) {
  RunMonitor monitor = make_monitor(true);
  acknowledge("tracker", 2);
  deliver(monitor);
  EXPECT_THAT(monitor.names_of("mapper"), ElementsAre("mapper"));
  EXPECT_THAT(monitor.names_of("egraph_server"), ElementsAre("egraph_server"));
  acknowledge("mapper.0", 2);
  send_status("mapper.1");
  send_status("mappers");
  end_stream(3);
  deliver(monitor);
  EXPECT_THAT(monitor.names_of("mapper"), ElementsAre("mapper.0", "mapper.1"));
  EXPECT_EQ(monitor.frames_done(), 0);
  acknowledge("mapper.1", 1);
  deliver(monitor);
  EXPECT_EQ(monitor.frames_done(), 2);
  EXPECT_FALSE(monitor.finished());
  acknowledge("mapper.1", 2);
  deliver(monitor);
  EXPECT_TRUE(monitor.finished());
}

TEST_F(RunTest, OldAndForeignAcknowledgementsDoNotCount) {
  RunMonitor monitor = make_monitor(true);
  acknowledge("tracker", 5);
  acknowledge("mapper", 5);
  acknowledge("mapper", 3);
  acknowledge("somebody", 1);
  deliver(monitor);
  EXPECT_EQ(monitor.frames_done(), 6);
}

TEST_F(RunTest, RealTimeIsOverWhenTheTrackerIsIdleAfterTheEnd) {
  RunMonitor monitor = make_monitor(false);
  send_pose(0);
  send_pose(4, false);
  send_pose(4, false);
  deliver(monitor);
  EXPECT_EQ(monitor.frames_done(), 2);
  EXPECT_EQ(monitor.poses(), 1);
  EXPECT_EQ(monitor.tracking_state(), "lost");
  deliver(monitor, 10s);
  EXPECT_FALSE(monitor.finished());  // a pause of the sensor
  end_stream(9);
  deliver(monitor);
  deliver(monitor, 1s);
  EXPECT_FALSE(monitor.finished());
  deliver(monitor, 1500ms);
  EXPECT_TRUE(monitor.finished());
}

TEST_F(RunTest, NamesWhoIsWaitedForWhenNothingMoves) {
  RunMonitor monitor = make_monitor(true);
  acknowledge("tracker", 9);
  acknowledge("mapper", 4);
  send_status("mapper");
  deliver(monitor);
  deliver(monitor, 59s);
  EXPECT_FALSE(monitor.stalled());
  send_status("tracker");
  deliver(monitor, 2s);
  ASSERT_TRUE(monitor.stalled());
  EXPECT_THAT(*monitor.stalled(), testing::AllOf(HasSubstr("61 s"), HasSubstr("mapper is waited for at frame 5"),
                                                 HasSubstr("service is mapper")));
}

TEST_F(RunTest, SaveIsAskedForUntilEveryServiceHasAnswered) {
  int asked = 0;
  peer_.subscribe<messages::Control>(channels::kControl, 0, [&](const messages::Control& control) {
    EXPECT_EQ(control.request_id, 7);
    EXPECT_EQ(control.command, messages::Command::save);
    ++asked;
  });
  const auto answer = [&](const std::string& service, bool ok, std::int64_t id = 7) {
    peer_.publish(channels::kControlReply, messages::ControlReply{id, service, ok, ok ? "" : "disk full"});
  };
  const auto round = [&](SaveRequest& request) {
    ASSERT_TRUE(peer_bus_.handle(0ms));
    ASSERT_TRUE(bus_.handle(0ms));
    request.update(now_);
  };

  SaveRequest request(context_, 7);
  request.start({"tracker", "mapper", "egraph_server"}, now_);
  answer("tracker", true);
  answer("mapper", true, 6);  // an answer to somebody else's question
  round(request);
  EXPECT_THAT(request.waiting_for(), ElementsAre("egraph_server", "mapper"));
  EXPECT_EQ(asked, 1);
  now_ += 600ms;
  round(request);
  round(request);
  EXPECT_EQ(asked, 2);
  answer("mapper", false);
  round(request);
  request.give_up_on("egraph_server");
  EXPECT_TRUE(request.done());
  EXPECT_THAT(request.failures(), ElementsAre(testing::Pair("mapper", "disk full")));
}

}  // namespace
}  // namespace eg::run
