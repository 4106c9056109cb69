// The whole tracker with the graph, on worlds known at the level of features.
#include "tests/unit/tracking/tracker_loop.hpp"

namespace eg::tracking {
namespace {

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
  for (const int seed : {3, 102}) {  // in 102, long lines leave the view one by one
    const FeatureSequence sequence =
        test::record(test::make_room(oblique_room()), camera_, turn_around(camera_, 180), seed);
    const SlamLoop slam = run(sequence);
    EXPECT_EQ(count(slam, TrackingState::tracking), 180);
    const test::LoopErrors errors = test::errors(slam.estimates(), sequence);
    EXPECT_LT(errors.worst_rotation, 0.5 * kDegree) << "seed " << seed;
    EXPECT_LT(errors.worst_translation, 0.03) << "seed " << seed;
  }
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

INSTANTIATE_TEST_SUITE_P(Cameras, TrackerLoop, two_cameras(), camera_name);

}  // namespace
}  // namespace eg::tracking
