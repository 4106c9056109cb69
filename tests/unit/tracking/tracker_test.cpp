// The whole tracker with the graph, on worlds known at the level of features.
#include "common/tracking/tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/random_geometry.hpp"
#include "tests/support/slam_loop.hpp"

namespace eg::tracking {
namespace {

using Eigen::Vector3d;
using features::FrameFeatures;
using geometry::Pose;
using test::FeatureSequence;
using test::kDegree;
using test::SlamLoop;

/// A room that is not aligned with anything.
test::RoomOptions oblique_room() {
  test::RoomOptions options;
  options.orientation = geometry::so3_exp({0.0, 0.3, 0.0});
  return options;
}

test::RoomOptions white_room() {
  test::RoomOptions options = oblique_room();
  options.corners_per_wall = 0;
  options.lines = false;
  return options;
}

/// Walks around the room's middle once, looking outwards.
std::vector<Pose> walk_around(const geometry::CameraModel& camera, int frames) {
  std::vector<Pose> poses;
  for (int i = 0; i < frames; ++i) {
    const double a = 2.0 * M_PI * i / frames;
    const Vector3d position(0.6 * std::sin(a), 0.15 * std::sin(3 * a), -0.6 * std::cos(a));
    const Vector3d target(2.0 * std::sin(a + 0.6), 0.3 * std::cos(2 * a), -2.0 * std::cos(a + 0.6));
    poses.push_back(test::looking_at(position, target, camera));
  }
  return poses;
}

/// Turns once about the camera's own centre.
std::vector<Pose> turn_around(const geometry::CameraModel& camera, int frames) {
  std::vector<Pose> poses;
  for (int i = 0; i < frames; ++i) {
    const double a = 2.0 * M_PI * i / frames;
    poses.push_back(test::looking_at({0.2, 0, 0.1}, Vector3d(0.2 + std::sin(a), 0.1, 0.1 + std::cos(a)), camera));
  }
  return poses;
}

/// Moves a little in front of a corner of the oblique room, all three walls in view.
std::vector<Pose> before_a_corner(const geometry::CameraModel& camera, int frames) {
  const Eigen::Matrix3d room = oblique_room().orientation;
  std::vector<Pose> poses;
  for (int i = 0; i < frames; ++i) {
    const double a = 0.05 * i;
    const Vector3d position(0.5 + 0.2 * std::sin(a), -0.3 + 0.1 * std::sin(0.7 * a), 0.4 * (1.0 - std::cos(0.8 * a)));
    poses.push_back(test::looking_at(room * position, room * Vector3d(2.5, 1.0, 2.5), camera));
  }
  return poses;
}

class TrackerLoop : public testing::TestWithParam<const char*> {
 protected:
  static SlamLoop run(const FeatureSequence& sequence) {
    SlamLoop slam;
    for (const FrameFeatures& frame : sequence.frames) EXPECT_TRUE(test::is_sound(slam.step(frame)));
    return slam;
  }

  static int count(const SlamLoop& slam, TrackingState state) {
    return static_cast<int>(std::count_if(slam.estimates().begin(), slam.estimates().end(),
                                          [state](const PoseEstimate& e) { return e.state == state; }));
  }

  geometry::CameraModel camera_ = *geometry::find_camera(GetParam());
};

TEST_P(TrackerLoop, WalksAroundARoom) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 1);
  const SlamLoop slam = run(sequence);
  EXPECT_EQ(count(slam, TrackingState::tracking), 240) << "no frame is lost";
  const test::LoopErrors errors = test::errors(slam.estimates(), sequence);
  // The first keyframe's own noise, 0.11 degrees per plane, stays in the map for good.
  EXPECT_LT(errors.mean_rotation, 0.25 * kDegree);
  EXPECT_LT(errors.worst_rotation, 0.6 * kDegree);
  EXPECT_LT(errors.mean_translation, 0.015);
  EXPECT_LT(errors.worst_translation, 0.03);

  EXPECT_GE(slam.keyframes().size(), 12U);
  EXPECT_LE(slam.keyframes().size(), 80U);
  for (std::size_t i = 0; i < slam.keyframes().size(); ++i) {
    EXPECT_EQ(slam.keyframes()[i].id.value, static_cast<std::int32_t>(i));
    EXPECT_EQ(slam.keyframes()[i].plane_distances.size(), slam.keyframes()[i].directions.size());
  }
  // Opposite walls are one direction: three of the box, one of the boards.
  const auto landmarks = slam.graph().landmarks();
  EXPECT_EQ(std::count_if(landmarks.begin(), landmarks.end(),
                          [](const auto& l) { return l.kind == egraph::DirectionKind::plane_normal; }),
            3);
  EXPECT_GT(slam.graph().edges().size(), slam.keyframes().size());
}

TEST_P(TrackerLoop, WithoutNoiseOnlyTheMotionPriorPulls) {
  test::SensorNoise exact;
  exact.disturb = false;
  const FeatureSequence sequence =
      test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 120), 1, exact);
  const SlamLoop slam = run(sequence);
  EXPECT_EQ(count(slam, TrackingState::tracking), 120);
  const test::LoopErrors errors = test::errors(slam.estimates(), sequence);
  // It does so in the first frames, which start from an unknown velocity.
  EXPECT_LT(errors.worst_rotation, 0.05 * kDegree);
  EXPECT_LT(errors.worst_translation, 0.003);
  EXPECT_LT(errors.mean_rotation, 0.01 * kDegree);
  EXPECT_LT(errors.mean_translation, 0.0005);
}

TEST_P(TrackerLoop, RotationIsMeasuredAgainstTheOldestKeyframe) {
  // Half a turn from the start nothing is seen that the first keyframe saw, but the same directions are.
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, turn_around(camera_, 120), 2);
  const SlamLoop slam = run(sequence);
  EXPECT_EQ(slam.estimates()[60].rotation_reference, egraph::KeyframeId{0});
  const auto with_reference = std::count_if(slam.estimates().begin() + 1, slam.estimates().end(),
                                            [](const PoseEstimate& e) { return e.rotation_reference.valid(); });
  EXPECT_EQ(with_reference, 119);
}

TEST_P(TrackerLoop, APureTurnOfThreeHundredAndSixtyDegreesDoesNotDrift) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, turn_around(camera_, 180), 3);
  const SlamLoop slam = run(sequence);
  EXPECT_EQ(count(slam, TrackingState::tracking), 180);
  const test::LoopErrors errors = test::errors(slam.estimates(), sequence);
  EXPECT_LT(errors.worst_rotation, 0.5 * kDegree);
  EXPECT_LT(errors.worst_translation, 0.03);
}

TEST_P(TrackerLoop, ThreeWhitePlanesAreEnough) {
  const FeatureSequence sequence =
      test::record(test::make_room(white_room()), camera_, before_a_corner(camera_, 150), 4);
  for (const FrameFeatures& frame : sequence.frames) {
    ASSERT_TRUE(frame.points.empty() && frame.lines.empty());
    ASSERT_EQ(frame.planes.size(), 3U);
  }
  const SlamLoop slam = run(sequence);
  EXPECT_EQ(count(slam, TrackingState::tracking), 150);
  const test::LoopErrors errors = test::errors(slam.estimates(), sequence);
  EXPECT_LT(errors.mean_rotation, 0.2 * kDegree);
  EXPECT_LT(errors.worst_rotation, 0.7 * kDegree);
  EXPECT_LT(errors.mean_translation, 0.01);
  EXPECT_LT(errors.worst_translation, 0.03);
}

TEST_P(TrackerLoop, TwoWhitePlanesGiveARotation) {
  // A corridor: both walls are seen, nothing tells how far along it the camera is.
  test::FeatureWorld corridor = test::make_room(white_room());
  std::erase_if(corridor.walls, [&](const test::WorldWall& wall) {
    return geometry::axial_angle(wall.normal, Vector3d::UnitY()) < 0.1;  // floor and ceiling
  });
  const FeatureSequence sequence = test::record(corridor, camera_, before_a_corner(camera_, 60), 5);
  const SlamLoop slam = run(sequence);
  EXPECT_EQ(count(slam, TrackingState::rotation_only), 59) << "all but the first";
  const test::LoopErrors errors = test::errors(slam.estimates(), sequence);
  EXPECT_EQ(errors.poses, 60) << "a rotation is a pose";
  EXPECT_LT(errors.worst_rotation, 1.0 * kDegree);
  EXPECT_GT(slam.keyframes().size(), 1U) << "the graph grows all the same";
  EXPECT_NE(slam.estimates().back().reason, "");
}

TEST_P(TrackerLoop, VanishedFeaturesMeanLostAndTheMapIsKept) {
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

TEST_P(TrackerLoop, AWhiteCornerIsFoundAgainToo) {
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

TEST_P(TrackerLoop, RelocalisesAtAPlaceSeenLongAgo) {
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

TEST_P(TrackerLoop, TimeNeverRunsBackwards) {
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

TEST_P(TrackerLoop, AFrameFromAnotherWorldIsNoKeyframe) {
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

TEST_P(TrackerLoop, TwoRunsAreIdentical) {
  const FeatureSequence sequence =
      test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 11);
  SlamLoop first;
  SlamLoop second;
  for (std::size_t i = 0; i < 80; ++i) {
    const PoseEstimate a = first.step(sequence.frames[i]);
    const PoseEstimate b = second.step(sequence.frames[i]);
    ASSERT_EQ(a.world_from_camera.rotation, b.world_from_camera.rotation) << "bit for bit, frame " << i;
    ASSERT_EQ(a.world_from_camera.translation, b.world_from_camera.translation);
    ASSERT_EQ(a.covariance, b.covariance);
    ASSERT_EQ(a.keyframe, b.keyframe);
  }
  ASSERT_EQ(first.tracker().map().points().size(), second.tracker().map().points().size());
  for (std::size_t i = 0; i < first.tracker().map().points().size(); ++i) {
    ASSERT_EQ(first.tracker().map().points()[i].position, second.tracker().map().points()[i].position);
  }
}

TEST_P(TrackerLoop, WaitsForAFrameThatCanStartAMap) {
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

TEST_P(TrackerLoop, ALongGapBetweenFramesIsBridged) {
  // Half a second without a frame, in which the camera keeps its speed.
  FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 480), 13);
  SlamLoop slam;
  for (std::size_t i = 0; i < 60; ++i) slam.step(sequence.frames[i]);
  for (std::size_t i = 72; i < 120; ++i) slam.step(sequence.frames[i]);
  EXPECT_TRUE(slam.estimates().back().has_pose);
  EXPECT_LT(test::errors(slam.estimates(), sequence).worst_translation, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Cameras, TrackerLoop, testing::Values("tum_fr3", "icl"),
                         [](const auto& camera) { return std::string(camera.param); });

}  // namespace
}  // namespace eg::tracking
