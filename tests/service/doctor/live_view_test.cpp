#include "services/doctor/live_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/messages/channels.hpp"
#include "services/doctor/machine_checks.hpp"
#include "services/doctor/probe.hpp"
#include "tests/support/bus_peer.hpp"

namespace eg::doctor {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
namespace channels = messages::channels;

constexpr std::int64_t kSecond = 1'000'000;

auto finding(Severity severity, const char* what) {
  return Contains(AllOf(Field(&Finding::severity, severity), Field(&Finding::what, HasSubstr(what)),
                        Field(&Finding::mend, testing::Not(IsEmpty()))));
}

class LiveViewTest : public testing::Test {
 protected:
  template <typename T>
  void send(const char* channel, const T& message, std::int64_t utime) {
    network_->set_time(utime);
    system_.send(channel, message);
    ASSERT_TRUE(bus_.handle(std::chrono::milliseconds(0)));
  }
  /// `skew`: of the sender's clock, microseconds.
  void send_status(const std::string& service, std::int64_t utime, std::int64_t skew = 0, std::int32_t pid = 1,
                   std::int64_t dropped = 0) {
    messages::ServiceStatus status;
    status.dropped = dropped;
    status.service = service;
    status.host = "robot";
    status.pid = pid;
    status.utime = utime + skew;
    status.cpu_seconds = 0.5 * 1e-6 * static_cast<double>(utime);
    send(channels::kStatus, status, utime);
  }
  void send_pose(std::int64_t sequence, std::int64_t utime) {
    tracking::PoseEstimate pose;
    pose.header = {1, sequence, 33'000 * sequence};
    send(channels::kPose, pose, utime);
  }

  std::shared_ptr<transport::MemoryNetwork> network_ = std::make_shared<transport::MemoryNetwork>();
  transport::MemoryBus bus_{network_};
  test::BusPeer system_{network_};
  LiveView view_{bus_};
};

TEST_F(LiveViewTest, SilenceIsNoFault) {
  const Findings findings = view_.judge(kSecond);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, Severity::good);
  EXPECT_EQ(view_.format(), "");
}

TEST_F(LiveViewTest, MeasuresCpuAndStepsAndFindsNothingWrong) {
  for (std::int64_t i = 0; i < 4; ++i) {
    const std::int64_t now = (10 + i) * kSecond;
    send_status("tracker", now);
    features::FrameFeatures features;
    features.header = {1, i, 33'000 * i};
    features.camera = {"tiny", 16, 12, 20, 20, 7.5, 5.5, {}, 1000, 10};
    send(channels::kFeatures, features, now + 10'000);
    send_pose(i, now + 15'000);
  }
  EXPECT_THAT(view_.judge(13 * kSecond), IsEmpty());
  const auto& tracker = view_.services().at("tracker on robot (1)");
  EXPECT_DOUBLE_EQ(tracker.cpu_percent(), 50.0);
  EXPECT_NEAR(view_.steps().at("FEATURES to POSE").percentile_ms(0.5), 5.0, 0.2);
  EXPECT_THAT(view_.format(), HasSubstr("FEATURES to POSE"));
}

TEST_F(LiveViewTest, NamesLostMessages) {
  for (const std::int64_t sequence : {0, 1, 5, 5}) send_pose(sequence, kSecond);
  EXPECT_THAT(view_.judge(kSecond), finding(Severity::warning, "3 of 6 messages on POSE"));
}

TEST_F(LiveViewTest, WhatIsSentOnRequestHasNoGaps) {
  for (const std::int64_t sequence : {40, 10}) {
    features::FrameFeatures features;
    features.header = {1, sequence, 33'000 * sequence};
    features.camera = {"tiny", 16, 12, 20, 20, 7.5, 5.5, {}, 1000, 10};
    send(channels::kKeyframeFeatures, features, kSecond);
    egraph::GraphSnapshot snapshot;
    snapshot.session = 1;
    snapshot.version = sequence;
    send(channels::kGraphSnapshot, snapshot, kSecond);
  }
  send(channels::kMeshRequest, messages::MeshRequest{1}, kSecond);
  EXPECT_THAT(view_.judge(kSecond), IsEmpty());
  EXPECT_EQ(view_.streams().channels().at(channels::kMeshRequest).type, "mesh_request_t");
}

TEST_F(LiveViewTest, BlamesAServiceThatLeavesFramesOutAndNotTheNetwork) {
  send_status("feature_extractor", kSecond);
  for (const std::int64_t sequence : {0, 1, 5}) send_pose(sequence, kSecond);
  send_status("feature_extractor", 2 * kSecond, 0, 1, 3);
  const Findings findings = view_.judge(2 * kSecond);
  EXPECT_THAT(findings, finding(Severity::warning, "feature_extractor on robot (1) missed 3 frames"));
  EXPECT_EQ(findings.size(), 1U) << "more receive buffer would not help";
}

TEST_F(LiveViewTest, NamesClockSkewInBothDirections) {
  send_status("tracker", kSecond, -200'000);
  send_status("mapper", kSecond, 300'000);
  const Findings findings = view_.judge(kSecond);
  EXPECT_THAT(findings, finding(Severity::warning, "the clock of robot is 200 ms behind"));
  EXPECT_THAT(findings, finding(Severity::warning, "the clock of robot is 300 ms ahead of"));
}

TEST_F(LiveViewTest, NamesSilentAndRivalServices) {
  send_status("tracker", kSecond, 0, 1);
  send_status("tracker", 5 * kSecond, 0, 2);
  const Findings findings = view_.judge(5 * kSecond);
  EXPECT_THAT(findings, finding(Severity::error, "tracker on robot (1) has been silent for 4 s"));
  EXPECT_THAT(findings, finding(Severity::warning, "2 processes call themselves tracker"));
}

TEST_F(LiveViewTest, MappersThatShareTheSpaceAreNoRivals) {
  send_status("mapper.0", kSecond, 0, 1);
  send_status("mapper.1", kSecond, 0, 2);
  EXPECT_THAT(view_.judge(kSecond), IsEmpty());
  send_status("mapper.1", kSecond, 0, 3);
  EXPECT_THAT(view_.judge(kSecond), finding(Severity::warning, "2 processes call themselves mapper.1"));
}

TEST_F(LiveViewTest, NamesMessagesOfOtherVersions) {
  system_.send_bytes(channels::kPose, messages::Bytes(100, 7));
  messages::Bytes cut = messages::encode(tracking::PoseEstimate{});
  cut.pop_back();
  system_.send_bytes(channels::kKeyframe, cut);
  ASSERT_TRUE(bus_.handle(std::chrono::milliseconds(0)));
  const Findings findings = view_.judge(0);
  EXPECT_THAT(findings, finding(Severity::error, "POSE carries messages of another type (0707070707070707)"));
  EXPECT_THAT(findings, finding(Severity::error, "1 of 1 messages on KEYFRAME are refused"));
}

TEST(Probe, CountsWhatComesBack) {
  const auto network = std::make_shared<transport::MemoryNetwork>();
  transport::MemoryBus bus(network);
  EXPECT_EQ(probe(bus).severity, Severity::good);
}

TEST(Probe, SaysThatNothingComesBack) {
  transport::MemoryNetwork::Disturbance all_lost;
  all_lost.loss = 1.0;
  transport::MemoryBus bus(std::make_shared<transport::MemoryNetwork>(all_lost));
  const Finding found = probe(bus);
  EXPECT_EQ(found.severity, Severity::error);
  EXPECT_THAT(found.what, HasSubstr("0 of 10"));
}

TEST(Probe, DoesNotMindWhatAnotherDoctorSends) {
  transport::MemoryNetwork::Disturbance each_twice;
  each_twice.duplication = 1.0;
  transport::MemoryBus bus(std::make_shared<transport::MemoryNetwork>(each_twice));
  const Finding found = probe(bus);
  EXPECT_EQ(found.severity, Severity::good);
  EXPECT_THAT(found.what, HasSubstr("10 of 10"));
  ASSERT_TRUE(bus.publish("DOCTOR_PROBE", std::vector<std::uint8_t>(1)));
  EXPECT_EQ(bus.handle(std::chrono::milliseconds(0)).value(), 2);  // the probe is over: nothing of it may be in use
}

TEST(MachineChecks, SayWhatToDoAboutTheUrl) {
  EXPECT_THAT(check_machine("udpm://239.255.76.67:7667?ttl=x"), finding(Severity::error, "'ttl=x'"));
  const Findings findings = check_machine("udpm://239.255.76.67:7667?ttl=3");
  EXPECT_THAT(findings, finding(Severity::warning, "ttl 3"));
  EXPECT_THAT(findings, finding(Severity::warning, "sets no receive buffer"));
  EXPECT_THAT(check_drops({1, 1}, {5, 1}), finding(Severity::warning, "threw 4 datagrams away"));
  EXPECT_THAT(check_drops({1, 1}, {1, 2}), finding(Severity::warning, "1 datagrams could not be put together"));
  EXPECT_THAT(check_drops({1, 1}, {1, 1}), IsEmpty());
}

}  // namespace
}  // namespace eg::doctor
