// One white wall fills the view: two turns and a distance are measured, the rest is predicted.
#include "common/tracking/observability.hpp"
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

INSTANTIATE_TEST_SUITE_P(Cameras, OneWall, two_cameras(), camera_name);

TEST(PredictedWhereUnobserved, TakesTheMeasuredPartOnly) {
  base::Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose predicted = test::random_pose(random, 2.0);
    Vector6d step;
    step << test::normal_vector(random, 0.1), test::normal_vector(random, 0.1);
    const Vector3d open = test::random_direction(random);
    Matrix6d information = 1e6 * Matrix6d::Identity();
    information.bottomRightCorner<3, 3>() -= (1e6 - 1.0) * open * open.transpose();
    const Pose kept =
        keep_predicted_where_unobserved({predicted, 0.04, 0.02}, perturb(predicted, step), information, 0.05);
    const Vector6d taken = pose_difference(predicted, kept);
    EXPECT_LT((taken.head<3>() - step.head<3>()).norm(), 1e-9);
    EXPECT_NEAR(open.dot(taken.tail<3>()), 0.0, 1e-6);
    const Vector3d measured = step.tail<3>() - open.dot(step.tail<3>()) * open;
    EXPECT_LT((taken.tail<3>() - measured).norm(), 1e-6);
  }
}

/// The turn about the wall's normal is not measured, and the landmark's normal is not quite that of the wall in the
/// map: an unlimited turn would lift the camera off, a turn as far as the prediction allows does not.
TEST(PredictedWhereUnobserved, KeepsTheDistanceFromASingleWall) {
  base::Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose predicted = test::random_pose(random, 2.0);
    const Vector3d wall = test::random_direction(random);
    const Vector3d landmark = test::disturbed_direction(wall, 0.002, random);
    const Vector3d centroid = -2.0 * wall + test::normal_vector(random, 0.3);
    Eigen::Matrix<double, 1, 6> height;
    height << centroid.cross(wall).transpose(), wall.transpose();
    const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(landmark);
    Matrix6d information = height.transpose() * height / (0.003 * 0.003);
    information.topLeftCorner<3, 3>() += basis * basis.transpose() / (0.002 * 0.002);
    Vector6d step;
    step << Vector3d::Zero(), test::normal_vector(random, 0.03);
    const Pose kept =
        keep_predicted_where_unobserved({predicted, 0.04, 0.02}, perturb(predicted, step), information, 0.05);
    const Vector3d taken = pose_difference(predicted, kept).tail<3>();
    EXPECT_NEAR(taken.dot(wall), step.tail<3>().dot(wall), 0.001);
    EXPECT_LT((taken - taken.dot(wall) * wall).norm(), 0.001);
  }
}

}  // namespace
}  // namespace eg::tracking
