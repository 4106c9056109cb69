#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/service/tracker/tracker_rig.hpp"
#include "tests/support/program.hpp"

namespace eg::services {
namespace {

constexpr std::size_t kFrames = 30;
constexpr std::array kResults = {"trajectory.txt", "states.csv", "keyframes.txt", "map.ply"};

void send(Rig& rig, std::size_t first, std::size_t end) {
  for (std::size_t i = first; i < end; ++i) {
    rig.send_frame(i);
    rig.answer_keyframes();
  }
}

class TrackerRestart : public testing::Test {
 protected:
  /// The results of a tracker that nobody killed.
  TrackerRestart() {
    Rig whole(true);
    send(whole, 0, kFrames);
    EXPECT_TRUE(whole.save());
    for (const char* name : kResults) undisturbed_.push_back(test::file_bytes(whole.folder() / name));
    keyframes_ = *whole.keyframes;
    for (const PoseEstimate& pose : *whole.poses) poses_.push_back(messages::encode(pose));
  }
  void expect_undisturbed(Rig& rig) {
    for (const PoseEstimate& pose : *rig.poses) {
      EXPECT_EQ(messages::encode(pose), poses_[static_cast<std::size_t>(pose.header.sequence)])
          << "to the last bit, frame " << pose.header.sequence;
    }
    ASSERT_TRUE(rig.save());
    for (std::size_t i = 0; i < kResults.size(); ++i) {
      EXPECT_TRUE(test::file_bytes(folder_.path() / kResults[i]) == undisturbed_[i]) << kResults[i];
    }
  }
  /// The server goes on: it knows the keyframes so far.
  static void take_over_server(Rig& rig, Rig& killed) { rig.builder = std::move(killed.builder); }

  test::TemporaryFolder folder_;
  std::vector<std::string> undisturbed_;
  std::vector<egraph::Keyframe> keyframes_;
  std::vector<messages::Bytes> poses_;  ///< by sequence
};

TEST_F(TrackerRestart, AKilledTrackerGoesOnAsIfNothingHadHappened) {
  auto rig = std::make_unique<Rig>(true, transport::MemoryNetwork::Disturbance{}, folder_.path());
  for (std::size_t i = 0; i < kFrames; ++i) {
    send(*rig, i, i + 1);
    if (i % 7 != 0) continue;
    auto next = std::make_unique<Rig>(true, transport::MemoryNetwork::Disturbance{}, folder_.path());
    take_over_server(*next, *rig);
    rig = std::move(next);  // the one before ends like a killed process: nothing is saved
    rig->send_frame(i);     // its acknowledgement may have been lost
    EXPECT_EQ(rig->order(), std::vector<std::int64_t>{static_cast<std::int64_t>(i)}) << "answered, not tracked again";
  }
  expect_undisturbed(*rig);
}

TEST_F(TrackerRestart, WhatWasRefusedIsInTheJournalToo) {
  const auto results = [](Rig& rig) {
    EXPECT_TRUE(rig.save());
    return test::file_bytes(rig.folder() / "states.csv") + test::file_bytes(rig.folder() / "trajectory.txt");
  };
  const auto send_with_a_mistake = [](Rig& rig, std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      FrameFeatures sent = frame(i);
      if (i == 4) sent.planes[0].plane.distance = NAN;
      rig.send(channels::kFeatures, sent);
      rig.answer_keyframes();
    }
  };
  Rig whole(true);
  send_with_a_mistake(whole, 0, 12);
  Rig killed(true, {}, folder_.path());
  send_with_a_mistake(killed, 0, 8);
  Rig resumed(true, {}, folder_.path());
  take_over_server(resumed, killed);
  send_with_a_mistake(resumed, 8, 12);
  const std::string expected = results(whole);
  EXPECT_EQ(results(resumed), expected);
  EXPECT_NE(expected.find("refused: FEATURES: field 'planes[0]"), std::string::npos) << expected;
}

TEST_F(TrackerRestart, AKeyframeWithoutAnUpdateIsAnnouncedAgain) {
  Rig killed(true, {}, folder_.path());
  killed.send_frame(0);
  ASSERT_EQ(killed.keyframes->size(), 1U);
  Rig resumed(true, {}, folder_.path());
  resumed.send_frame(1);
  EXPECT_TRUE(resumed.poses->empty()) << "frame 1 waits for the graph";
  resumed.idle(1'000'000);
  resumed.idle(2'000'000);
  resumed.answer_keyframes();
  EXPECT_EQ(resumed.order(), (std::vector<std::int64_t>{0, 1}))
      << "the keyframe, too, is answered when the graph has it";
  send(resumed, 2, kFrames);
  expect_undisturbed(resumed);
}

TEST_F(TrackerRestart, HalfAFrameAtTheEndIsTrackedAgain) {
  {
    Rig killed(true, {}, folder_.path());
    send(killed, 0, 1);
    killed.send_frame(1);
  }
  const auto journal = folder_.path() / "tracker.journal";
  std::filesystem::resize_file(journal, std::filesystem::file_size(journal) - 100);
  Rig resumed(true, {}, folder_.path());
  ASSERT_TRUE(resumed.builder.add_keyframe(keyframes_.front()));
  send(resumed, 1, kFrames);
  expect_undisturbed(resumed);
}

TEST_F(TrackerRestart, AJournalThatIsTooLargeIsGivenUpAndNothingElse) {
  constexpr std::size_t kKept = 5;
  const auto journal = folder_.path() / "tracker.journal";
  Rig killed(true, {}, folder_.path());
  send(killed, 0, kKept);
  const std::uintmax_t bytes = std::filesystem::file_size(journal);
  Rig rig(true, {}, folder_.path(), bytes + 1);  // its former length counts
  take_over_server(rig, killed);
  EXPECT_TRUE(std::filesystem::exists(journal));
  send(rig, kKept, kFrames);
  EXPECT_FALSE(std::filesystem::exists(journal)) << "half a session would be of no use";
  expect_undisturbed(rig);
}

TEST_F(TrackerRestart, ADamagedJournalIsRefusedByName) {
  {
    Rig killed(true, {}, folder_.path());
    send(killed, 0, 3);
  }
  const auto journal = folder_.path() / "tracker.journal";
  std::fstream file(journal, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(2);  // in the first event's mark
  file << "xx";
  file.close();
  transport::MemoryBus bus(std::make_shared<transport::MemoryNetwork>());
  service::ServiceContext context(bus, {"tracker", {}, {}, {}, folder_.path(), true});
  TrackerService tracker(context, {});
  const auto resumed = tracker.resume();
  ASSERT_FALSE(resumed);
  EXPECT_THAT(resumed.error().message, testing::HasSubstr("tracker.journal"));
}

}  // namespace
}  // namespace eg::services
