#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "tests/service/tracker/tracker_rig.hpp"

namespace eg::services {
namespace {

using tracking::TrackingState;

std::vector<std::int64_t> numbers(std::int64_t count) {
  std::vector<std::int64_t> result;
  for (std::int64_t i = 0; i < count; ++i) result.push_back(i);
  return result;
}

TEST(TrackerService, AnswersEveryFrameWithAPoseAndAnAcknowledgement) {
  Rig rig(true);
  for (std::size_t i = 0; i < 20; ++i) {
    rig.send_frame(i);
    rig.answer_keyframes();
  }
  EXPECT_EQ(rig.order(), numbers(20));
  for (const PoseEstimate& pose : *rig.poses) EXPECT_EQ(pose.state, TrackingState::tracking);
  ASSERT_EQ(rig.acknowledged->size(), 20U);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ((*rig.acknowledged)[i].sequence, static_cast<std::int64_t>(i));
    EXPECT_EQ((*rig.acknowledged)[i].session, 1);
    EXPECT_EQ((*rig.acknowledged)[i].consumer, "tracker");
  }
  EXPECT_EQ(rig.keyframes->front().id, egraph::KeyframeId{0});
  EXPECT_EQ(rig.poses->front().keyframe, egraph::KeyframeId{0});
  EXPECT_EQ(rig.status().frames, 20);
  EXPECT_EQ(rig.status().dropped, 0);
  EXPECT_EQ(rig.status().rejected, 0);
}

TEST(TrackerService, InLockstepTheNextFrameWaitsForTheGraphUpdate) {
  Rig rig(true);
  rig.send_frame(0);
  ASSERT_EQ(rig.keyframes->size(), 1U);
  rig.send_frame(1);
  rig.send_frame(2);
  rig.send_frame(0);
  EXPECT_TRUE(rig.poses->empty()) << "the keyframe itself is answered when the map has followed the graph";
  rig.answer_keyframes();
  EXPECT_EQ(rig.order(), numbers(3));
}

/// Whatever the clock: lockstep would wait for a frame without an answer for ever.
TEST(TrackerService, AFrameThatIsRefusedIsAnsweredWithTheReason) {
  for (const bool lockstep : {true, false}) {
    Rig rig(lockstep);
    for (std::size_t i = 0; i < 20; ++i) {
      FrameFeatures sent = frame(i);
      if (i == 0 || i == 10) sent.points[3].pixel.x() = std::nan("");
      rig.send(channels::kFeatures, sent);
      rig.answer_keyframes();
    }
    ASSERT_EQ(rig.order(), numbers(20));
    for (const std::size_t i : {std::size_t{0}, std::size_t{10}}) {
      const PoseEstimate& refused = (*rig.poses)[i];
      EXPECT_EQ(refused.state, i == 0 ? TrackingState::initialising : TrackingState::tracking) << "as before";
      EXPECT_FALSE(refused.has_pose);
      EXPECT_EQ(refused.reason, "refused: FEATURES: field 'points[3].pixel' is not finite");
      EXPECT_FALSE(refused.keyframe.valid());
    }
    for (std::size_t i = 11; i < 20; ++i) EXPECT_TRUE((*rig.poses)[i].has_pose) << i;
    EXPECT_EQ(rig.acknowledged->size(), 20U);
    EXPECT_EQ(rig.status().rejected, 2);
  }
}

TEST(TrackerService, InRealTimeNothingWaits) {
  Rig rig(false);
  for (std::size_t i = 0; i < 5; ++i) rig.send_frame(i);
  EXPECT_EQ(rig.order(), numbers(5));
}

TEST(TrackerService, InLockstepFramesAreTrackedInOrder) {
  Rig rig(true);
  rig.send_frame(2);
  rig.send_frame(1);
  EXPECT_TRUE(rig.poses->empty());
  rig.send_frame(0);
  rig.answer_keyframes();
  EXPECT_EQ(rig.order(), numbers(3));
}

TEST(TrackerService, InRealTimeMissingFramesAreCountedAndLateOnesIgnored) {
  Rig rig(false);
  rig.send_frame(0);
  rig.send_frame(3);
  rig.send_frame(2);
  EXPECT_EQ(rig.order(), (std::vector<std::int64_t>{0, 3}));
  EXPECT_EQ(rig.status().dropped, 2);
}

TEST(TrackerService, AFrameThatComesAgainIsAnsweredAgainNotTrackedAgain) {
  Rig rig(true);
  rig.send_frame(0);
  rig.answer_keyframes();
  rig.send_frame(1);
  rig.send_frame(0);
  rig.send_frame(1);
  EXPECT_EQ(rig.order(), (std::vector<std::int64_t>{0, 1, 0, 1}));
  EXPECT_EQ(messages::encode((*rig.poses)[3]), messages::encode((*rig.poses)[1]));
  EXPECT_EQ(rig.acknowledged->size(), 4U);
  EXPECT_EQ(rig.status().frames, 2);
  EXPECT_EQ(rig.keyframes->size(), 1U);
}

TEST(TrackerService, AnnouncesAKeyframeAgainUntilTheUpdateComes) {
  Rig rig(true);
  rig.idle(1'000'000);
  rig.send_frame(0);
  rig.idle(1'100'000);
  EXPECT_EQ(rig.keyframes->size(), 1U) << "too soon";
  rig.idle(1'350'000);
  rig.idle(1'360'000);
  ASSERT_EQ(rig.keyframes->size(), 2U);
  EXPECT_EQ(messages::encode((*rig.keyframes)[1]), messages::encode((*rig.keyframes)[0]));
  rig.idle(1'700'000);
  EXPECT_EQ(rig.keyframes->size(), 3U);
  rig.answer_keyframes();
  rig.idle(9'000'000);
  EXPECT_EQ(rig.keyframes->size(), 3U) << "confirmed";
}

TEST(TrackerService, AsksForASnapshotAfterAGapAndGoesOn) {
  Rig rig(false);
  egraph::GraphUpdate missed;
  std::size_t next = 0;
  while (rig.keyframes->size() < 2 && next < recording().frames.size()) rig.send_frame(next++);
  ASSERT_EQ(rig.keyframes->size(), 2U);
  ASSERT_TRUE(rig.builder.add_keyframe((*rig.keyframes)[0]).has_value());  // its update is lost
  const auto second = rig.builder.add_keyframe((*rig.keyframes)[1]);
  rig.send(channels::kGraphUpdate, *second);
  ASSERT_EQ(rig.requests->size(), 1U);
  EXPECT_EQ(rig.requests->front().session, 1);
  EXPECT_EQ(rig.requests->front().have_version, 0);

  rig.send(channels::kGraphSnapshot, rig.builder.graph().snapshot(1));
  rig.idle(0);
  rig.idle(5'000'000);
  ASSERT_GT(rig.keyframes->size(), 2U) << "in real time the newest comes again for those who missed one";
  for (std::size_t i = 2; i < rig.keyframes->size(); ++i) EXPECT_EQ((*rig.keyframes)[i].id.value, 1) << "confirmed";
  rig.send_frame(next);
  EXPECT_GE(rig.poses->back().rotation_reference.value, 0) << "the graph is there";
}

TEST(TrackerService, SendsCorrectionsAndKeyframePosesAgainToWhoAsks) {
  Rig rig(true);
  const auto corrections = rig.collect<tracking::PoseCorrection>(channels::kPoseCorrection);
  for (std::size_t i = 0; i < recording().frames.size(); ++i) {
    rig.send_frame(i);
    rig.answer_keyframes();
  }
  ASSERT_FALSE(corrections->empty());
  const std::int64_t newest = corrections->back().version;
  EXPECT_EQ(rig.poses->back().corrections, newest) << "a pose says what there is to be missed";

  rig.send(channels::kResend, messages::ResendRequest{1, channels::kPoseCorrection, {0}});
  const tracking::PoseCorrection all = corrections->back();
  EXPECT_EQ(all.since, 0);
  EXPECT_EQ(all.version, newest);
  std::map<std::int32_t, geometry::Pose> latest;
  for (const auto& correction : *corrections) {
    for (const auto& entry : correction.entries) latest[entry.keyframe.value] = entry.world_from_camera;
  }
  ASSERT_EQ(all.entries.size(), latest.size());
  for (const auto& entry : all.entries) {
    EXPECT_EQ(entry.world_from_camera.translation, latest.at(entry.keyframe.value).translation);
  }

  const std::size_t before = rig.poses->size();
  rig.send(channels::kResend, messages::ResendRequest{1, channels::kPose, {0, 99}});
  ASSERT_EQ(rig.poses->size(), before + 1) << "one of them there is not";
  EXPECT_EQ(messages::encode(rig.poses->back()), messages::encode(rig.poses->front()));
}

TEST(TrackerService, SendsTheFeaturesOfKeyframesAgainToWhoAsks) {
  Rig rig(true);
  for (std::size_t i = 0; i < 3; ++i) {
    rig.send_frame(i);
    rig.answer_keyframes();
  }
  const auto features = rig.collect<features::FrameFeatures>(channels::kKeyframeFeatures);
  rig.send(channels::kResend, messages::ResendRequest{1, channels::kKeyframeFeatures, {0, 99}});
  ASSERT_EQ(features->size(), 1U) << "one of them there is not";
  EXPECT_EQ(messages::encode(features->front()), messages::encode(recording().frames.front()));
}

TEST(TrackerService, ASnapshotReleasesWaitingFramesInLockstep) {
  Rig rig(true);
  rig.send_frame(0);
  rig.send_frame(1);
  ASSERT_TRUE(rig.builder.add_keyframe(rig.keyframes->front()).has_value());
  rig.send(channels::kGraphSnapshot, rig.builder.graph().snapshot(1));
  EXPECT_EQ(rig.order(), numbers(2));
}

TEST(TrackerService, FollowsWhatTheServerHasRefinedAndAnnouncesIt) {
  Rig rig(true);
  const auto corrections = rig.collect<tracking::PoseCorrection>(channels::kPoseCorrection);
  std::size_t next = 0;
  while (rig.keyframes->size() < 2) {
    rig.answer_keyframes();
    rig.send_frame(next++);
  }
  egraph::GraphUpdate update = rig.builder.add_keyframe(rig.keyframes->back()).value();
  geometry::Pose refined = update.keyframe.world_from_camera;
  refined.translation += Eigen::Vector3d(0.02, 0.0, 0.01);
  update.corrections = {{egraph::KeyframeId{1}, refined}};
  const Eigen::Vector3d before = rig.keyframes->back().world_from_camera.translation;
  corrections->clear();
  rig.send(channels::kGraphUpdate, update);
  rig.send(channels::kGraphUpdate, update);
  ASSERT_EQ(corrections->size(), 1U) << "once";
  ASSERT_EQ(corrections->front().entries.size(), 1U);
  EXPECT_EQ(corrections->front().entries[0].keyframe, egraph::KeyframeId{1});
  EXPECT_EQ(corrections->front().entries[0].world_from_camera.translation, refined.translation);
  EXPECT_EQ(corrections->front().entries[0].world_from_camera.rotation, refined.rotation);
  EXPECT_EQ(rig.poses->back().corrections, corrections->front().version) << "the answer to the keyframe says so";

  rig.send_frame(next);
  EXPECT_EQ(rig.poses->back().state, TrackingState::tracking);
  // The camera moves 2 cm a frame to the right, and half of the map, which both keyframes made, moved with it.
  EXPECT_GT(rig.poses->back().world_from_camera.translation.x() - before.x(), 0.022);
}

TEST(TrackerService, IgnoresGraphsOfOtherSessionsAndOldOnes) {
  Rig rig(true);
  rig.send_frame(0);
  ASSERT_TRUE(rig.builder.add_keyframe(rig.keyframes->front()).has_value());
  egraph::GraphSnapshot empty;
  empty.session = 1;
  rig.send(channels::kGraphSnapshot, empty);
  rig.send(channels::kGraphSnapshot, rig.builder.graph().snapshot(2));
  egraph::GraphUpdate foreign;
  foreign.session = 2;
  foreign.base_version = 5;
  foreign.version = 6;
  foreign.keyframe.id = egraph::KeyframeId{5};
  rig.send(channels::kGraphUpdate, foreign);
  EXPECT_TRUE(rig.requests->empty());
  rig.send_frame(1);
  EXPECT_TRUE(rig.poses->empty()) << "still waiting for its own";
}

TEST(TrackerService, RefusesFramesOfAnotherSession) {
  Rig rig(true);
  rig.send_frame(0);
  rig.answer_keyframes();
  FrameFeatures foreign = frame(1);
  foreign.header.session = 2;
  rig.send(channels::kFeatures, foreign);
  EXPECT_EQ(rig.order(), numbers(1));
  EXPECT_EQ(rig.status().rejected, 1);
  EXPECT_NE(rig.status().last_rejection.find("session"), std::string::npos);
  rig.send_frame(1);
  EXPECT_EQ(rig.order(), numbers(2));
}

TEST(TrackerService, AnotherSessionBeginsANewMapWhenTheOneBeforeIsOver) {
  Rig rig(true);
  for (std::size_t i = 0; i < 12; ++i) {
    rig.send_frame(i);
    rig.answer_keyframes();
  }
  FrameFeatures other = frame(0);
  other.header.session = 7;
  rig.send(channels::kFeatures, other);
  EXPECT_EQ(rig.order(), numbers(12)) << "session 1 goes on";
  rig.send(channels::kEndOfStream, messages::EndOfStream{1, 12, {}});
  rig.poses->clear();
  rig.keyframes->clear();

  rig.send(channels::kFeatures, other);
  ASSERT_EQ(rig.keyframes->size(), 1U);
  EXPECT_EQ(rig.keyframes->front().header.session, 7);
  EXPECT_EQ(rig.keyframes->front().id, egraph::KeyframeId{0});
  egraph::GraphBuilder graph;
  rig.send(channels::kGraphUpdate, graph.add_keyframe(rig.keyframes->front()).value());
  EXPECT_EQ(rig.order(), numbers(1));
  EXPECT_EQ(rig.acknowledged->back().session, 7);

  rig.send_frame(3);
  EXPECT_EQ(rig.order(), numbers(1)) << "a late frame of session 1 does not bring it back";
  EXPECT_TRUE(std::filesystem::exists(rig.folder() / "session-1" / "trajectory.txt"));
  ASSERT_TRUE(rig.save().has_value());
  EXPECT_TRUE(std::filesystem::exists(rig.folder() / "trajectory.txt"));
}

TEST(TrackerService, AnotherSessionBeginsWhenNothingIsHeardOfTheOneBefore) {
  Rig rig(false);
  FrameFeatures other = frame(0);
  other.header.session = 7;
  rig.idle(1'000'000);
  rig.send_frame(0);
  rig.idle(2'000'000);
  rig.send(channels::kFeatures, other);
  EXPECT_EQ(rig.poses->size(), 1U) << "a pause, no end";
  rig.idle(4'000'000);
  rig.send(channels::kFeatures, other);
  ASSERT_EQ(rig.poses->size(), 2U);
  EXPECT_EQ(rig.poses->back().header.session, 7);
}

TEST(TrackerService, InRealTimeOneAbsurdNumberShutsOutNoFrames) {
  constexpr std::int64_t kFar = 1'000'000'000'000;
  Rig rig(false);
  rig.send_frame(0);
  FrameFeatures absurd = frame(1);
  absurd.header.sequence = kFar;
  rig.send(channels::kFeatures, absurd);
  EXPECT_NE(rig.status().last_rejection.find("'sequence' leaps from 0 to 1000000000000"), std::string::npos);
  rig.send_frame(1);
  EXPECT_EQ(rig.order(), (std::vector<std::int64_t>{0, 1}));
  EXPECT_EQ(rig.status().dropped, 0);
  // Two that agree are the source's.
  for (std::size_t i = 2; i < 4; ++i) {
    FrameFeatures later = frame(i);
    later.header.sequence = kFar + static_cast<std::int64_t>(i);
    rig.send(channels::kFeatures, later);
  }
  EXPECT_EQ(rig.order(), (std::vector<std::int64_t>{0, 1, kFar + 3}));
}

TEST(TrackerService, InLockstepAbsurdNumbersTakeNoPlace) {
  Rig rig(true);
  FrameFeatures absurd = frame(1);
  for (int i = 0; i < 100; ++i) {
    absurd.header.sequence = 1'000'000 + i;
    rig.send(channels::kFeatures, absurd);
  }
  rig.send_frame(0);
  rig.answer_keyframes();
  rig.send_frame(1);
  EXPECT_EQ(rig.order(), (std::vector<std::int64_t>{0, 1}));
}

TEST(TrackerService, FeaturesThatAreNoNumbersAreRefusedByName) {
  Rig rig(false);
  rig.send_frame(0);
  FrameFeatures wrong = frame(1);
  wrong.points.front().depth = std::nan("");
  rig.send(channels::kFeatures, wrong);
  wrong = frame(2);
  wrong.directions.front().direction.x() = std::nan("");
  rig.send(channels::kFeatures, wrong);
  EXPECT_EQ(rig.status().rejected, 2);
  EXPECT_NE(rig.status().last_rejection.find("FEATURES: field 'directions[0]"), std::string::npos)
      << rig.status().last_rejection;
  rig.send_frame(3);
  EXPECT_EQ(rig.order(), (std::vector<std::int64_t>{0, 1, 2, 3}));
  EXPECT_FALSE((*rig.poses)[1].has_pose || (*rig.poses)[2].has_pose);
  EXPECT_EQ(rig.poses->back().state, tracking::TrackingState::tracking);
}

TEST(TrackerService, SurvivesNonsense) {
  Rig rig(true);
  for (const char* channel :
       {channels::kFeatures, channels::kGraphUpdate, channels::kGraphSnapshot, channels::kEndOfStream}) {
    rig.send_bytes(channel, {});
    rig.send_bytes(channel, {0xde, 0xad, 0xbe, 0xef});
  }
  EXPECT_EQ(rig.status().rejected, 8);
  rig.send_frame(0);
  rig.answer_keyframes();
  EXPECT_EQ(rig.order(), numbers(1));
}

TEST(TrackerService, ALossyNetworkGivesTheSameResult) {
  Rig undisturbed(true);
  for (std::size_t i = 0; i < 30; ++i) {
    undisturbed.send_frame(i);
    undisturbed.answer_keyframes();
  }
  Rig lossy(true, {.loss = 0.3, .duplication = 0.2, .reordering = 0.2, .seed = 3});
  std::int64_t now = 0;
  for (int round = 0; round < 5'000; ++round) {
    // The source sends the frames again that nobody has acknowledged, four at a time.
    std::set<std::int64_t> done;
    for (const messages::Acknowledge& acknowledge : *lossy.acknowledged) done.insert(acknowledge.sequence);
    if (done.size() == 30) break;
    int window = 0;
    for (std::size_t i = 0; i < 30 && window < 4; ++i) {
      if (done.contains(static_cast<std::int64_t>(i))) continue;
      lossy.send_frame(i);
      ++window;
    }
    lossy.answer_keyframes();
    lossy.idle(now += 100'000);
  }
  std::map<std::int64_t, messages::Bytes> answers;
  for (const PoseEstimate& pose : *lossy.poses) answers[pose.header.sequence] = messages::encode(pose);
  ASSERT_GT(answers.size(), 20U) << "poses are a stream: a lost one is not sent again unless its frame is";
  for (const auto& [sequence, answer] : answers) {
    EXPECT_EQ(answer, messages::encode((*undisturbed.poses)[static_cast<std::size_t>(sequence)])) << sequence;
  }
  EXPECT_EQ(lossy.status().frames, 30);
}

}  // namespace
}  // namespace eg::services
