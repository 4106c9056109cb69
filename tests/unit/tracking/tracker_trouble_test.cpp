// What goes wrong in front of a camera, and how the tracker bears it.
#include "tests/unit/tracking/tracker_loop.hpp"

namespace eg::tracking {
namespace {

using TrackerInTrouble = TrackerLoop;

TEST_P(TrackerInTrouble, VanishedFeaturesMeanLostAndTheMapIsKept) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 6);
  SlamLoop slam;
  for (std::size_t i = 0; i < 160; ++i) {
    FrameFeatures frame = sequence.frames[i];
    const bool blind = i >= 100 && i < 110;
    if (blind) {
      frame.points.clear();
      frame.lines.clear();
      frame.planes.clear();
      frame.directions.clear();
    }
    const std::size_t points_before = slam.tracker().map().points().size();
    const PoseEstimate estimate = slam.step(frame);
    EXPECT_TRUE(test::is_sound(estimate));
    if (blind) {
      EXPECT_EQ(estimate.state, TrackingState::lost) << "frame " << i;
      EXPECT_FALSE(estimate.has_pose);
      EXPECT_FALSE(estimate.keyframe.valid());
      EXPECT_NE(estimate.reason, "");
      EXPECT_EQ(slam.tracker().map().points().size(), points_before);
    }
  }
  EXPECT_EQ(slam.estimates()[110].state, TrackingState::relocalised);
  EXPECT_TRUE(slam.estimates()[110].has_pose);
  for (std::size_t i = 111; i < 160; ++i) EXPECT_EQ(slam.estimates()[i].state, TrackingState::tracking) << i;
  EXPECT_EQ(slam.tracker().map().keyframes().front().id, KeyframeId{0}) << "one map";
  const test::LoopErrors errors = test::errors(slam.estimates(), sequence);
  EXPECT_EQ(errors.poses, 150);
  EXPECT_LT(errors.worst_rotation, 0.7 * kDegree);
  EXPECT_LT(errors.worst_translation, 0.04);
}

/// As if a frame's directions were taken for their neighbours: the points know better.
TEST_P(TrackerInTrouble, DirectionsThatLeadAwayFromAllPointsAreNotFollowed) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 6);
  Tracker tracker;
  egraph::GraphBuilder builder;
  std::vector<PoseEstimate> estimates;
  std::size_t end = sequence.frames.size();
  for (std::size_t i = 0; i < end; ++i) {
    const TrackResult result = tracker.track(sequence.frames[i]);
    estimates.push_back(result.estimate);
    if (!result.keyframe) continue;
    ASSERT_TRUE(tracker.follow(*builder.add_keyframe(*result.keyframe)).has_value());
    if (i < 40) continue;
    // Right after a keyframe: local adjustment, which believes the graph, has no part in the next three frames.
    egraph::GraphSnapshot turned = builder.graph().snapshot(sequence.frames[i].header.session);
    ++turned.version;
    const Eigen::Matrix3d turn = geometry::so3_exp(5.0 * kDegree * Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0);
    for (egraph::DirectionLandmark& landmark : turned.landmarks) {
      landmark.direction = turn * landmark.direction;
      landmark.covariance = turn * landmark.covariance * turn.transpose();
    }
    ASSERT_TRUE(tracker.follow(turned).has_value());
    end = i + 4;
  }
  ASSERT_LT(end, sequence.frames.size()) << "no keyframe after frame 40";
  for (const PoseEstimate& estimate : estimates) EXPECT_EQ(estimate.state, TrackingState::tracking);
  const test::LoopErrors errors = test::errors(estimates, sequence);
  EXPECT_LT(errors.worst_rotation, 0.7 * kDegree);
  EXPECT_LT(errors.worst_translation, 0.04);
}

/// Ten frames a second, so that the prediction is less sharp than the gates of planes; every direction of ten frames is
/// wrong by twenty degrees, each another way.
TEST_P(TrackerInTrouble, ContradictoryDirectionsNeitherTurnTheCameraNorAKeyframe) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 6);
  base::Random random(4);
  SlamLoop slam;
  for (std::size_t i = 0; i < 80; ++i) {
    FrameFeatures frame = sequence.frames[i];
    frame.header.utime *= 3;
    for (std::size_t d = 0; i >= 40 && i < 50 && d < frame.directions.size(); ++d) {
      const Eigen::Matrix3d turn = geometry::so3_exp(20.0 * kDegree * test::random_direction(random));
      frame.directions[d].direction = turn * frame.directions[d].direction;
      frame.directions[d].covariance = turn * frame.directions[d].covariance * turn.transpose();
    }
    EXPECT_EQ(slam.step(frame).state, TrackingState::tracking) << "frame " << i;
  }
  const test::LoopErrors errors = test::errors(slam.estimates(), sequence);
  EXPECT_LT(errors.worst_rotation, 0.7 * kDegree);
  EXPECT_LT(errors.worst_translation, 0.04);
}

TEST_P(TrackerInTrouble, AWhiteCornerIsFoundAgainToo) {
  const FeatureSequence sequence =
      test::record(test::make_room(white_room()), camera_, before_a_corner(camera_, 60), 14);
  SlamLoop slam;
  for (std::size_t i = 0; i < 60; ++i) {
    FrameFeatures frame = sequence.frames[i];
    if (i >= 30 && i < 36) {
      frame.planes.clear();
      frame.directions.clear();
    }
    slam.step(frame);
  }
  for (std::size_t i = 30; i < 36; ++i) EXPECT_EQ(slam.estimates()[i].state, TrackingState::lost);
  EXPECT_EQ(slam.estimates()[36].state, TrackingState::relocalised);
  EXPECT_EQ(slam.estimates().back().state, TrackingState::tracking);
  EXPECT_LT(test::errors(slam.estimates(), sequence).worst_translation, 0.04);
}

/// Somewhere in two seconds the camera may have turned to other walls, whose directions are as good.
TEST_P(TrackerInTrouble, DirectionsAloneDoNotEndALongLoss) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 6);
  SlamLoop slam;
  for (std::size_t i = 0; i < 100; ++i) {
    FrameFeatures frame = sequence.frames[std::min<std::size_t>(i, 50)];
    frame.header = sequence.frames[i].header;
    if (i >= 50) {
      frame.points.clear();
      frame.lines.clear();
      std::erase_if(frame.directions,
                    [](const auto& direction) { return direction.kind != features::DirectionKind::plane_normal; });
      for (features::PlaneFeature& plane : frame.planes) {  // a metre behind those that are known
        plane.plane.distance += 1.0;
        plane.centroid -= plane.plane.normal;
      }
    }
    if (i >= 50 && i < 95) {
      frame.planes.clear();
      frame.directions.clear();
    }
    const PoseEstimate estimate = slam.step(frame);
    if (i < 50) continue;
    EXPECT_EQ(estimate.state, TrackingState::lost) << "frame " << i;
    EXPECT_FALSE(estimate.has_pose || estimate.keyframe.valid()) << "frame " << i;
  }
}

TEST_P(TrackerInTrouble, RelocalisesAtAPlaceSeenLongAgo) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 7);
  SlamLoop slam;
  for (std::size_t i = 0; i < 120; ++i) slam.step(sequence.frames[i]);
  // Carried back to the start with the lens covered, for three seconds.
  constexpr std::int64_t kFrame = 33'333;  // microseconds
  image::FrameHeader header = sequence.frames[119].header;
  FrameFeatures dark;
  dark.camera = camera_;
  for (int i = 0; i < 90; ++i) {
    header = {header.session, header.sequence + 1, header.utime + kFrame};
    dark.header = header;
    EXPECT_EQ(slam.step(dark).state, TrackingState::lost);
  }
  int found = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    FrameFeatures frame = sequence.frames[i];
    frame.header = header = {header.session, header.sequence + 1, header.utime + kFrame};
    const PoseEstimate estimate = slam.step(frame);
    if (!estimate.has_pose) continue;
    EXPECT_EQ(estimate.state, found++ == 0 ? TrackingState::relocalised : TrackingState::tracking);
    const Pose& truth = sequence.world_from_camera[i];
    EXPECT_LT(geometry::rotation_angle_between(estimate.world_from_camera.rotation, truth.rotation), 1.0 * kDegree);
    EXPECT_LT((estimate.world_from_camera.translation - truth.translation).norm(), 0.05);
  }
  EXPECT_GT(found, 25) << "all keyframes are tried in turn, three a frame";
}

TEST_P(TrackerInTrouble, TimeNeverRunsBackwards) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 8);
  SlamLoop slam;
  for (std::size_t i = 0; i < 30; ++i) slam.step(sequence.frames[i]);
  const std::size_t keyframes = slam.keyframes().size();
  const std::size_t points = slam.tracker().map().points().size();
  for (const std::size_t old : {std::size_t{29}, std::size_t{28}, std::size_t{0}}) {
    const PoseEstimate estimate = slam.step(sequence.frames[old]);
    EXPECT_FALSE(estimate.has_pose);
    EXPECT_NE(estimate.reason.find("time"), std::string::npos) << estimate.reason;
    EXPECT_FALSE(estimate.keyframe.valid());
  }
  EXPECT_EQ(slam.keyframes().size(), keyframes);
  EXPECT_EQ(slam.tracker().map().points().size(), points);
  const PoseEstimate next = slam.step(sequence.frames[30]);
  EXPECT_EQ(next.state, TrackingState::tracking) << "a refused frame is not lost track";
}

TEST_P(TrackerInTrouble, ARefusedFrameChangesNoState) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 8);
  SlamLoop slam;
  for (std::size_t i = 0; i < 20; ++i) slam.step(sequence.frames[i]);
  const PoseEstimate doubled = slam.step(sequence.frames[19]);
  EXPECT_EQ(doubled.state, TrackingState::tracking);
  EXPECT_FALSE(doubled.has_pose);
  EXPECT_NE(doubled.reason, "");
}

TEST_P(TrackerInTrouble, OneStampFromTheFutureDoesNotShutOutTheNextFrames) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 8);
  SlamLoop slam;
  for (std::size_t i = 0; i < 20; ++i) slam.step(sequence.frames[i]);
  FrameFeatures future = sequence.frames[20];
  future.header.utime += 1'000'000'000'000;
  const PoseEstimate refused = slam.step(future);
  EXPECT_FALSE(refused.has_pose);
  EXPECT_NE(refused.reason.find("time"), std::string::npos) << refused.reason;
  EXPECT_EQ(slam.step(sequence.frames[21]).state, TrackingState::tracking);
}

/// Three stamps from the future, which confirm each other, or somebody sets the clock: a second later time goes on.
TEST_P(TrackerInTrouble, AClockThatWasSetBackIsFollowed) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 960), 8);
  SlamLoop slam;
  for (std::size_t i = 0; i < 70; ++i) {
    FrameFeatures frame = sequence.frames[i];
    if (i >= 20 && i < 23) frame.header.utime += 3'600'000'000;
    const PoseEstimate estimate = slam.step(frame);
    const bool shut_out = estimate.reason.find("time") != std::string::npos;
    EXPECT_EQ(shut_out, i == 20 || (i >= 23 && i < 53)) << "frame " << i;
    EXPECT_EQ(estimate.has_pose, !shut_out) << "frame " << i;
  }
  EXPECT_EQ(slam.estimates()[53].state, TrackingState::relocalised);
  EXPECT_EQ(slam.estimates().back().state, TrackingState::tracking);
  const test::LoopErrors errors = test::errors(slam.estimates(), sequence);
  EXPECT_LT(errors.worst_rotation, 0.7 * kDegree);
  EXPECT_LT(errors.worst_translation, 0.04);
}

TEST_P(TrackerInTrouble, ALongPauseTakesTwoFramesToBeBelieved) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 8);
  SlamLoop slam;
  for (std::size_t i = 0; i < 20; ++i) slam.step(sequence.frames[i]);
  std::vector<PoseEstimate> after;
  for (std::size_t i = 20; i < 26; ++i) {
    FrameFeatures later = sequence.frames[i];
    later.header.utime += 600'000'000;
    after.push_back(slam.step(later));
  }
  EXPECT_FALSE(after.front().has_pose);
  EXPECT_TRUE(after.back().has_pose) << after.back().reason;
}

TEST_P(TrackerInTrouble, AFrameFromAnotherWorldIsNoKeyframe) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 9);
  test::RoomOptions elsewhere;
  elsewhere.half_size = {1.7, 1.6, 1.9};
  elsewhere.orientation = geometry::so3_exp({0.3, 1.0, 0.2});
  elsewhere.seed = 99;
  const FeatureSequence other = test::record(test::make_room(elsewhere), camera_, walk_around(camera_, 240), 10);
  SlamLoop slam;
  for (std::size_t i = 0; i < 60; ++i) slam.step(sequence.frames[i]);
  const std::size_t keyframes = slam.keyframes().size();
  for (std::size_t i = 60; i < 70; ++i) {
    const PoseEstimate estimate = slam.step(other.frames[i]);
    EXPECT_FALSE(estimate.keyframe.valid()) << "frame " << i;
    EXPECT_NE(estimate.state, TrackingState::tracking) << "frame " << i;
  }
  EXPECT_EQ(slam.keyframes().size(), keyframes);
  for (std::size_t i = 70; i < 90; ++i) slam.step(sequence.frames[i]);
  EXPECT_EQ(slam.estimates().back().state, TrackingState::tracking) << "back in its own world";
}

TEST_P(TrackerInTrouble, WaitsForAFrameThatCanStartAMap) {
  const FeatureSequence sequence =
      test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 12);
  SlamLoop slam;
  FrameFeatures empty;
  empty.camera = camera_;
  empty.header = {1, 0, 1};
  const PoseEstimate waiting = slam.step(empty);
  EXPECT_EQ(waiting.state, TrackingState::initialising);
  EXPECT_FALSE(waiting.has_pose);
  EXPECT_NE(waiting.reason, "");
  const PoseEstimate started = slam.step(sequence.frames[0]);
  EXPECT_EQ(started.state, TrackingState::tracking);
  EXPECT_EQ(started.keyframe, KeyframeId{0});
  EXPECT_TRUE(started.world_from_camera.rotation.isIdentity());
  EXPECT_TRUE(started.world_from_camera.translation.isZero());
}

TEST_P(TrackerInTrouble, ALongGapBetweenFramesIsBridged) {
  // Half a second without a frame, in which the camera keeps its speed.
  FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 480), 13);
  SlamLoop slam;
  for (std::size_t i = 0; i < 60; ++i) slam.step(sequence.frames[i]);
  for (std::size_t i = 72; i < 120; ++i) slam.step(sequence.frames[i]);
  EXPECT_TRUE(slam.estimates().back().has_pose);
  EXPECT_LT(test::errors(slam.estimates(), sequence).worst_translation, 0.05);
}

/// Ten seconds without a frame, in which the camera comes back to where it was, or to where it was long ago.
TEST_P(TrackerInTrouble, AfterTenSecondsWithoutAFrameNoPoseIsWrong) {
  constexpr std::int64_t kGap = 10'000'000;  // microseconds
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 7);
  for (const std::size_t first : {std::size_t{110}, std::size_t{0}}) {
    SlamLoop slam;
    for (std::size_t i = 0; i < 120; ++i) slam.step(sequence.frames[i]);
    int found = 0;
    for (std::size_t i = 0; i < 40; ++i) {
      FrameFeatures frame = sequence.frames[first + i];
      frame.header = sequence.frames[120 + i].header;
      frame.header.utime += kGap;
      const PoseEstimate estimate = slam.step(frame);
      EXPECT_TRUE(test::is_sound(estimate));
      if (!estimate.has_pose) continue;
      ++found;
      const Pose& truth = sequence.world_from_camera[first + i];
      EXPECT_LT(geometry::rotation_angle_between(estimate.world_from_camera.rotation, truth.rotation), 1.0 * kDegree);
      EXPECT_LT((estimate.world_from_camera.translation - truth.translation).norm(), 0.05);
    }
    EXPECT_GT(found, 25) << "from frame " << first;
  }
}

/// Shortly after a loss the camera looks the other way in a box-shaped room: three planes fit a pose that is 180
/// degrees off.
TEST_P(TrackerInTrouble, PlanesAloneAreNoProofWhereManyPointsContradict) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 7);
  SlamLoop slam;
  for (std::size_t i = 0; i < 120; ++i) slam.step(sequence.frames[i]);
  for (std::size_t i = 0; i < 40; ++i) {
    FrameFeatures frame = i < 3 ? FrameFeatures{} : sequence.frames[i];
    frame.camera = camera_;
    frame.header = sequence.frames[120 + i].header;
    const PoseEstimate estimate = slam.step(frame);
    if (!estimate.has_pose) continue;
    const Pose& truth = sequence.world_from_camera[i];
    EXPECT_LT(geometry::rotation_angle_between(estimate.world_from_camera.rotation, truth.rotation), 1.0 * kDegree);
  }
}

/// The same without a loss before it: six tenths of a second without a frame, in which the camera is turned around.
TEST_P(TrackerInTrouble, ALongStepIsNoProofEither) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 7);
  SlamLoop slam;
  for (std::size_t i = 0; i < 120; ++i) slam.step(sequence.frames[i]);
  int found = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    FrameFeatures frame = sequence.frames[i];
    frame.header = sequence.frames[120 + i].header;
    frame.header.utime += 600'000;
    const PoseEstimate estimate = slam.step(frame);
    if (!estimate.has_pose) continue;
    ++found;
    const Pose& truth = sequence.world_from_camera[i];
    EXPECT_LT(geometry::rotation_angle_between(estimate.world_from_camera.rotation, truth.rotation), 1.0 * kDegree);
  }
  EXPECT_GT(found, 30);
}

/// The same when a dozen points happen to look like those that were expected.
TEST_P(TrackerInTrouble, ADozenOfManyExpectedPointsIsNoProofEither) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 7);
  SlamLoop slam;
  for (std::size_t i = 0; i < 120; ++i) slam.step(sequence.frames[i]);
  FrameFeatures turned = sequence.frames[0];
  const std::vector<features::PointFeature>& expected = sequence.frames[119].points;
  turned.points.insert(turned.points.end(), expected.begin(), expected.begin() + 12);
  turned.header = sequence.frames[120].header;
  turned.header.utime += 600'000;
  const PoseEstimate estimate = slam.step(turned);
  ASSERT_TRUE(estimate.has_pose) << estimate.reason;
  EXPECT_EQ(estimate.state, TrackingState::relocalised);
  const Pose& truth = sequence.world_from_camera[0];
  EXPECT_LT(geometry::rotation_angle_between(estimate.world_from_camera.rotation, truth.rotation), 1.0 * kDegree);
}

/// After a loss, in a place never seen, ten of hundreds of points fit where the camera was last.
TEST_P(TrackerInTrouble, TenOfHundredsAreNoEndOfALoss) {
  test::RoomOptions room = oblique_room();
  room.corners_per_wall = 300;
  const FeatureSequence sequence = test::record(test::make_room(room), camera_, walk_around(camera_, 240), 9);
  SlamLoop slam;
  for (std::size_t i = 0; i < 30; ++i) slam.step(sequence.frames[i]);
  FrameFeatures nothing;
  nothing.camera = camera_;
  nothing.header = sequence.frames[30].header;
  EXPECT_EQ(slam.step(nothing).state, TrackingState::lost);
  FrameFeatures elsewhere = sequence.frames[150];  // the opposite wall
  ASSERT_GT(elsewhere.points.size(), 120U);
  const std::vector<features::PointFeature>& last = sequence.frames[29].points;
  elsewhere.points.insert(elsewhere.points.end(), last.begin(), last.begin() + 10);
  elsewhere.header = sequence.frames[31].header;
  elsewhere.header.utime += 1'200'000;
  const PoseEstimate estimate = slam.step(elsewhere);
  EXPECT_EQ(estimate.state, TrackingState::lost) << estimate.matched_points << " points";
  EXPECT_FALSE(estimate.has_pose || estimate.keyframe.valid());
}

INSTANTIATE_TEST_SUITE_P(Cameras, TrackerInTrouble, two_cameras(), camera_name);

}  // namespace
}  // namespace eg::tracking
