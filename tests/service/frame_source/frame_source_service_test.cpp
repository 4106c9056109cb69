#include "services/frame_source/frame_source_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "common/io/trajectory_file.hpp"
#include "common/messages/channels.hpp"
#include "common/transport/memory_bus.hpp"
#include "tests/service/frame_source/fake_input.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg {
namespace {

using messages::Acknowledge;
using messages::EndOfStream;
using test::FakeInput;
using testing::ElementsAre;
namespace channels = messages::channels;

/// A frame source and those who listen to it, on a network in memory and a clock of the test's own.
class FrameSource : public testing::Test {
 protected:
  void start(std::unique_ptr<services::FrameInput> input, bool lockstep,
             const transport::MemoryNetwork::Disturbance& disturbance = {}, const std::filesystem::path& out = {}) {
    network_ = std::make_shared<transport::MemoryNetwork>(disturbance);
    source_bus_ = std::make_unique<transport::MemoryBus>(network_);
    listener_bus_ = std::make_unique<transport::MemoryBus>(network_);
    service::ServiceOptions service_options;
    service_options.name = "frame_source";
    service_options.lockstep = lockstep;
    service_options.out = out;
    source_context_ = std::make_unique<service::ServiceContext>(*source_bus_, service_options);
    listener_context_ = std::make_unique<service::ServiceContext>(*listener_bus_, service::ServiceOptions{});
    listener_context_->subscribe<image::RgbdFrame>(channels::kRgbd, 0, [this](const image::RgbdFrame& frame) {
      received_.push_back(frame.header);
      indices_.push_back(FakeInput::index_of(frame));
      receive_times_.push_back(now_);
      acknowledge_what_is_complete();
    });
    listener_context_->subscribe<EndOfStream>(channels::kEndOfStream, 0,
                                              [this](const EndOfStream& end) { ends_.push_back(end); });
    services::FrameSourceOptions options;
    options.input.session = kSession;
    source_ = std::make_unique<services::FrameSourceService>(*source_context_, options, std::move(input));
  }

  void acknowledge(const std::string& consumer, std::int64_t sequence, std::int64_t session = kSession) {
    listener_context_->publish(channels::kAcknowledge, Acknowledge{session, sequence, consumer});
  }

  /// As consumers do: up to the last frame before which none is missing.
  void acknowledge_what_is_complete() {
    std::int64_t next = 0;
    const std::vector<std::int64_t> got = sequences();
    while (std::find(got.begin(), got.end(), next) != got.end()) ++next;
    if (next == 0) return;
    for (const std::string& consumer : acknowledging_) acknowledge(consumer, next - 1);
  }

  /// Lets `seconds` pass in steps of 20 ms.
  void run(double seconds) {
    for (int step = 0; step < static_cast<int>(seconds / 0.02); ++step) {
      EXPECT_TRUE(source_bus_->handle(std::chrono::milliseconds(0)).has_value());
      source_->idle(now_);
      EXPECT_TRUE(listener_bus_->handle(std::chrono::milliseconds(0)).has_value());
      now_ += 20'000;
    }
  }

  [[nodiscard]] std::vector<std::int64_t> sequences() const {
    std::vector<std::int64_t> sequences;
    for (const image::FrameHeader& header : received_) sequences.push_back(header.sequence);
    return sequences;
  }

  static constexpr std::int64_t kSession = 7;
  std::vector<std::string> acknowledging_ = {"tracker", "mapper"};
  std::vector<image::FrameHeader> received_;
  std::vector<std::int64_t> indices_;
  std::vector<std::int64_t> receive_times_;
  std::vector<EndOfStream> ends_;
  std::int64_t now_ = 1'000'000'000;
  std::shared_ptr<transport::MemoryNetwork> network_;
  std::unique_ptr<transport::MemoryBus> source_bus_, listener_bus_;
  std::unique_ptr<service::ServiceContext> source_context_, listener_context_;
  std::unique_ptr<services::FrameSourceService> source_;
};

TEST_F(FrameSource, SendsEveryFrameOnceAndThenTheEnd) {
  start(std::make_unique<FakeInput>(8), true);
  run(2.0);
  EXPECT_THAT(sequences(), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  for (const image::FrameHeader& header : received_) {
    EXPECT_EQ(header.session, kSession);
    EXPECT_EQ(header.utime, 5'000'000 + 100'000 * header.sequence);
  }
  ASSERT_GE(ends_.size(), 2U) << "the end is repeated";
  EXPECT_EQ(ends_[0].frame_count, 8);
  EXPECT_EQ(ends_[0].session, kSession);
  EXPECT_TRUE(ends_[0].skipped_utimes.empty());
  EXPECT_FALSE(source_->finished());
}

TEST_F(FrameSource, NeverRunsMoreThanThreeFramesAheadOfTheSlowestConsumer) {
  acknowledging_ = {"tracker"};
  start(std::make_unique<FakeInput>(10), true);
  run(0.3);
  EXPECT_THAT(sequences(), ElementsAre(0, 1, 2));
  acknowledge("mapper", 1);
  run(0.2);
  EXPECT_THAT(sequences(), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_TRUE(ends_.empty());
}

TEST_F(FrameSource, IgnoresAcknowledgementsThatAreNotForItsFrames) {
  acknowledging_ = {};
  start(std::make_unique<FakeInput>(10), true);
  run(0.1);
  for (const char* consumer : {"tracker", "mapper"}) {
    acknowledge(consumer, 2, kSession + 1);  // another session
  }
  acknowledge("stranger", 2);
  run(0.2);
  EXPECT_THAT(sequences(), ElementsAre(0, 1, 2));
}

// As when the source was killed and has started from the beginning.
TEST_F(FrameSource, LeavesOutWhatItsConsumersHaveFromASourceBefore) {
  acknowledging_ = {};
  start(std::make_unique<FakeInput>(10), true);
  run(0.1);
  acknowledge("tracker", 1000);
  acknowledge("mapper", 4);
  run(0.2);
  EXPECT_THAT(sequences(), ElementsAre(0, 1, 2, 5, 6, 7)) << "the slowest decides";
}

TEST_F(FrameSource, SendsTheOldestFrameAgainWhenNobodyAnswers) {
  acknowledging_ = {};
  start(std::make_unique<FakeInput>(10), true);
  run(0.4);
  EXPECT_THAT(sequences(), ElementsAre(0, 1, 2));
  run(0.4);
  EXPECT_THAT(sequences(), ElementsAre(0, 1, 2, 0));
  acknowledging_ = {"tracker", "mapper"};  // they start late
  run(6.0);
  ASSERT_FALSE(ends_.empty());
  EXPECT_EQ(std::set<std::int64_t>(indices_.begin(), indices_.end()).size(), 10U);
}

TEST_F(FrameSource, LosesNothingOnALossyNetwork) {
  start(std::make_unique<FakeInput>(30), true, {.loss = 0.25, .duplication = 0.1, .reordering = 0.2, .seed = 3});
  run(120.0);
  const auto got = sequences();
  EXPECT_EQ(std::set<std::int64_t>(got.begin(), got.end()).size(), 30U);
  EXPECT_FALSE(ends_.empty());
}

TEST_F(FrameSource, LeavesOutUnreadableFramesWithoutAGapInTheSequence) {
  start(std::make_unique<FakeInput>(7, std::set<std::int64_t>{2, 3, 6}), true);
  run(2.0);
  EXPECT_THAT(sequences(), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(indices_, ElementsAre(0, 1, 4, 5));
  EXPECT_EQ(received_[2].utime, 5'400'000);
  ASSERT_FALSE(ends_.empty());
  EXPECT_EQ(ends_[0].frame_count, 4);
  EXPECT_THAT(ends_[0].skipped_utimes, ElementsAre(5'200'000, 5'300'000, 5'600'000));
}

TEST_F(FrameSource, EndsAtOnceWhenNoFrameCanBeRead) {
  start(std::make_unique<FakeInput>(2, std::set<std::int64_t>{0, 1}), true);
  run(0.5);
  EXPECT_TRUE(received_.empty());
  ASSERT_FALSE(ends_.empty());
  EXPECT_EQ(ends_[0].frame_count, 0);
}

TEST_F(FrameSource, RealtimeStartsWhenAllConsumersAreThereAndKeepsTheRecordingsPace) {
  start(std::make_unique<FakeInput>(5), false);
  messages::ServiceStatus status;
  status.utime = 1;
  status.service = "tracker";
  listener_context_->publish(channels::kStatus, status);
  run(1.0);
  EXPECT_TRUE(received_.empty());
  status.service = "mapper";
  listener_context_->publish(channels::kStatus, status);
  run(2.0);
  EXPECT_THAT(sequences(), ElementsAre(0, 1, 2, 3, 4));
  for (std::size_t i = 1; i < receive_times_.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(receive_times_[i] - receive_times_[0]), 1e5 * static_cast<double>(i), 20'001.0);
  }
  ASSERT_FALSE(ends_.empty());
  EXPECT_EQ(ends_[0].frame_count, 5);
}

TEST(RealtimePacer, WaitsForEachOfTheMappersThatShareTheSpace) {
  services::RealtimePacer pacer({"tracker", "mapper.0", "mapper.1"});
  pacer.heard_of("tracker");
  pacer.heard_of("mapper.0");
  EXPECT_FALSE(pacer.until(0, 0).has_value());
  pacer.heard_of("mapper.1");
  EXPECT_EQ(pacer.until(0, 0), 0);
}

TEST_F(FrameSource, RealtimeDoesNotWaitLongerThanTenSeconds) {
  start(std::make_unique<FakeInput>(3), false);
  run(9.9);
  EXPECT_TRUE(received_.empty());
  run(1.0);
  EXPECT_EQ(received_.size(), 3U);
}

TEST_F(FrameSource, WritesTheTruePosesOfASyntheticScene) {
  const test::TemporaryFolder folder;
  auto input =
      services::open_input({.dataset = "synthetic:corner", .camera = "", .max_frames = 4, .seed = 1, .noise = false});
  ASSERT_TRUE(input.has_value()) << input.error().message;
  start(*std::move(input), true, {}, folder.path());
  ASSERT_TRUE(source_->save().has_value());
  const auto poses = io::read_trajectory(folder.path() / "groundtruth.txt");
  ASSERT_TRUE(poses.has_value()) << poses.error().message;
  EXPECT_EQ(poses->size(), 4U);
  EXPECT_DOUBLE_EQ(poses->front().time_s, 1.0);
}

TEST(FrameSourceOptions, LockstepNeedsConsumers) {
  services::FrameSourceOptions options;
  EXPECT_TRUE(validate(options, true).has_value());
  options.consumers.clear();
  EXPECT_FALSE(validate(options, true).has_value());
  EXPECT_TRUE(validate(options, false).has_value());
}

}  // namespace
}  // namespace eg
