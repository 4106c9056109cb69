// One white wall fills the view: two turns and a distance are measured, the rest is predicted.
#include "common/tracking/pose_optimizer.hpp"
#include "tests/unit/tracking/tracker_loop.hpp"

namespace eg::tracking {
namespace {

using OneWall = TrackerLoop;

/// Only the wall most in front of the first camera and its normal are left of the frame.
FrameFeatures seen_as_one_wall(FrameFeatures frame, const Pose& world_from_camera) {
  const auto front = std::min_element(frame.planes.begin(), frame.planes.end(), [&](const auto& a, const auto& b) {
    return (world_from_camera.rotation * a.plane.normal).z() < (world_from_camera.rotation * b.plane.normal).z();
  });
  const auto index = static_cast<std::int32_t>(front - frame.planes.begin());
  std::erase_if(frame.directions, [&](const auto& direction) {
    return direction.kind != features::DirectionKind::plane_normal || direction.source != index;
  });
  for (auto& direction : frame.directions) direction.source = 0;
  frame.planes = {features::PlaneFeature(*front)};
  frame.points.clear();
  frame.lines.clear();
  return frame;
}

TEST_P(OneWall, KeepsTheRotationUntilTheNextWallComes) {
  const FeatureSequence sequence =
      test::record(test::make_room(white_room()), camera_, before_a_corner(camera_, 150), 21);
  SlamLoop slam;
  for (std::size_t i = 0; i < 150; ++i) {
    const bool one_wall = i >= 30 && i < 120;
    const PoseEstimate estimate =
        slam.step(one_wall ? seen_as_one_wall(sequence.frames[i], sequence.world_from_camera[i]) : sequence.frames[i]);
    EXPECT_TRUE(test::is_sound(estimate));
    ASSERT_TRUE(estimate.has_pose) << "frame " << i << ": " << estimate.reason;
    const double error =
        geometry::rotation_angle_between(estimate.world_from_camera.rotation, sequence.world_from_camera[i].rotation);
    if (!one_wall) {
      EXPECT_LT(error, 1.0 * kDegree) << "frame " << i;
      continue;
    }
    EXPECT_EQ(estimate.state, TrackingState::rotation_only);
    EXPECT_NE(estimate.reason, "");
    EXPECT_FALSE(estimate.keyframe.valid()) << "a guess is no keyframe";
    EXPECT_LT(error, 8.0 * kDegree) << "frame " << i;
  }
  EXPECT_EQ(slam.estimates().back().state, TrackingState::tracking);
}

TEST_P(OneWall, SaysLostWhenTheTurnHasNotBeenSeenForLong) {
  const FeatureSequence sequence =
      test::record(test::make_room(white_room()), camera_, before_a_corner(camera_, 40), 22);
  SlamLoop slam;
  for (const FrameFeatures& frame : sequence.frames) slam.step(frame);
  FrameFeatures wall = seen_as_one_wall(sequence.frames.back(), sequence.world_from_camera.back());
  TrackingState state = TrackingState::tracking;
  int followed = 0;
  while (state != TrackingState::lost && followed < 2000) {
    wall.header.sequence += 1;
    wall.header.utime += 33'333;
    state = slam.step(wall).state;
    followed += state == TrackingState::rotation_only ? 1 : 0;
  }
  EXPECT_GT(followed, 300) << "ten seconds are no reason";
  EXPECT_LT(followed, 1000) << "half a minute is";
}

/// Nothing else is known that could set right what was predicted: the first frame with more begins the map.
TEST_P(OneWall, IsNoEndOfTheMapWhereItBegins) {
  const FeatureSequence sequence =
      test::record(test::make_room(oblique_room()), camera_, before_a_corner(camera_, 60), 23);
  for (const std::size_t walls : {std::size_t{1}, std::size_t{10}}) {
    SlamLoop slam;
    for (std::size_t i = 0; i < 60; ++i) {
      const Pose& truth = sequence.world_from_camera[i];
      const PoseEstimate estimate =
          slam.step(i < walls ? seen_as_one_wall(sequence.frames[i], truth) : sequence.frames[i]);
      EXPECT_TRUE(estimate.has_pose) << "frame " << i << ": " << estimate.reason;
      if (i == walls) {
        EXPECT_EQ(estimate.state, TrackingState::rotation_only);
        EXPECT_TRUE(estimate.keyframe.valid()) << estimate.reason;
      }
      if (i <= walls) continue;
      EXPECT_EQ(estimate.state, TrackingState::tracking) << "frame " << i << ": " << estimate.reason;
      EXPECT_LT(geometry::rotation_angle_between(estimate.world_from_camera.rotation, truth.rotation), 2.0 * kDegree);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, OneWall, two_cameras(), camera_name);

/// The turn about the wall's normal is not measured, and the landmark's normal is not quite that of the wall in the
/// map: an unlimited turn would lift the camera off, a turn as far as the prediction allows does not.
TEST(PredictedWhereUnobserved, TheDistanceFromASingleWallIsTheMeasuredOne) {
  base::Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose predicted = test::random_pose(random, 2.0);
    const Vector3d wall = test::random_direction(random);  // in the camera frame, two metres away
    const Vector3d centroid = -2.0 * wall + 0.3 * geometry::tangent_basis(wall) * Eigen::Vector2d(0.5, -0.7);
    const double step = 0.03 * random.normal();  // towards the wall, not foreseen
    PoseProblem problem;
    problem.camera = *geometry::find_camera("tum_fr3");
    problem.prior = known_within(predicted, 0.04, 0.02);
    const Vector3d in_world = predicted.inverse().rotation * wall;
    const Vector3d on_wall = predicted.inverse() * (centroid - step * wall);
    problem.planes.push_back({{in_world, -in_world.dot(on_wall)}, centroid, 0.003});
    const Eigen::Matrix3d tangential = 0.002 * 0.002 * (Eigen::Matrix3d::Identity() - wall * wall.transpose());
    problem.directions.push_back({test::disturbed_direction(in_world, 0.002, random), wall, tangential});
    const PoseSolution solution = optimize_pose(problem, predicted, FreeParameters::pose);
    const Vector3d taken = pose_difference(predicted, solution.camera_from_world).tail<3>();
    EXPECT_NEAR(taken.dot(wall), step, 0.005);
    EXPECT_LT((taken - taken.dot(wall) * wall).norm(), 0.002) << "where nothing is measured";
  }
}

}  // namespace
}  // namespace eg::tracking
