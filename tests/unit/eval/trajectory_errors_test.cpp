#include "common/eval/trajectory_errors.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "common/base/random.hpp"
#include "common/geometry/so3.hpp"

namespace eg::eval {
namespace {

using geometry::Pose;
using geometry::StampedPose;
using Trajectory = std::vector<StampedPose>;

constexpr double kDegree = std::numbers::pi / 180.0;

Eigen::Vector3d random_vector(base::Random& random) { return {random.normal(), random.normal(), random.normal()}; }

/// A winding camera path at 10 Hz.
Trajectory winding_path(int count = 101) {
  Trajectory trajectory;
  for (int i = 0; i < count; ++i) {
    const double t = 0.1 * i;
    const Pose pose{geometry::so3_exp({0.3 * std::sin(t), 0.2 * t, 0.1 * std::cos(2 * t)}),
                    {std::cos(t), std::sin(1.3 * t), 0.1 * t}};
    trajectory.push_back({100.0 + t, pose});
  }
  return trajectory;
}

Trajectory moved(const Trajectory& trajectory, const Pose& b_from_a) {
  Trajectory result = trajectory;
  for (StampedPose& pose : result) pose.world_from_camera = b_from_a * pose.world_from_camera;
  return result;
}

TEST(TrajectoryErrors, AMovedCopyHasNone) {
  base::Random random(1);
  const Trajectory reference = winding_path();
  for (int round = 0; round < 20; ++round) {
    const Pose motion{geometry::so3_exp(2.0 * random_vector(random)), 10.0 * random_vector(random)};
    const auto errors = evaluate_trajectory(moved(reference, motion), reference);
    ASSERT_TRUE(errors.has_value());
    EXPECT_EQ(errors->matched_poses, 101U);
    EXPECT_NEAR(errors->coverage, 1.0, 1e-9);
    EXPECT_LT(errors->ate_m.max, 1e-12);
    EXPECT_LT(errors->are_aligned_deg.max, 1e-5);
    EXPECT_LT(errors->are_first_pose_deg.max, 1e-5);
    EXPECT_EQ(errors->rpe_translation_m.count, 91U);
    EXPECT_LT(errors->rpe_translation_m.max, 1e-12);
    EXPECT_LT(errors->rpe_rotation_deg.max, 1e-5);
  }
}

TEST(TrajectoryErrors, PositionErrorsAlternatingAcrossAStraightPath) {
  // Points of a straight line displaced by +-3 cm, so that no rigid motion helps: each error is exactly 3 cm.
  Trajectory reference, estimate;
  for (int i = 0; i < 40; ++i) {
    StampedPose pose{0.1 * i, {}};
    pose.world_from_camera.translation = {0.05 * (i / 4), 0.0, 0.0};
    reference.push_back(pose);
    const double sign = (i % 4 == 0 || i % 4 == 3) ? 1.0 : -1.0;
    pose.world_from_camera.translation.y() = 0.03 * sign;
    estimate.push_back(pose);
  }
  const auto errors = evaluate_trajectory(estimate, reference);
  ASSERT_TRUE(errors.has_value());
  EXPECT_NEAR(errors->ate_m.rmse, 0.03, 1e-12);
  EXPECT_NEAR(errors->ate_m.mean, 0.03, 1e-12);
  EXPECT_NEAR(errors->ate_m.median, 0.03, 1e-12);
  EXPECT_NEAR(errors->ate_m.max, 0.03, 1e-12);
  EXPECT_NEAR(errors->are_aligned_deg.max, 0.0, 1e-6);
}

TEST(TrajectoryErrors, ScaleIsNotAlignedAway) {
  Trajectory reference = winding_path(), estimate = reference;
  for (StampedPose& pose : estimate) pose.world_from_camera.translation *= 1.1;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const StampedPose& pose : reference) mean += pose.world_from_camera.translation / 101.0;
  double variance = 0.0;
  for (const StampedPose& pose : reference)
    variance += (pose.world_from_camera.translation - mean).squaredNorm() / 101.0;
  EXPECT_NEAR(evaluate_trajectory(estimate, reference)->ate_m.rmse, 0.1 * std::sqrt(variance), 1e-12);
}

TEST(TrajectoryErrors, AMirroredTrajectoryDoesNotAlign) {
  const Trajectory reference = winding_path();
  Trajectory estimate = reference;
  for (StampedPose& pose : estimate) pose.world_from_camera.translation.y() *= -1.0;
  EXPECT_GT(evaluate_trajectory(estimate, reference)->ate_m.rmse, 0.1);
}

TEST(TrajectoryErrors, RotationErrorsOfOneWrongPose) {
  // 12 degrees at one pose of 101: first-pose alignment sees exactly 12/101 on average.
  const Trajectory reference = winding_path();
  Trajectory estimate = reference;
  Eigen::Matrix3d& wrong = estimate[50].world_from_camera.rotation;
  wrong = wrong * geometry::so3_exp({0, 12 * kDegree, 0});
  const auto errors = evaluate_trajectory(estimate, reference);
  EXPECT_NEAR(errors->are_first_pose_deg.mean, 12.0 / 101.0, 1e-9);
  EXPECT_NEAR(errors->are_first_pose_deg.max, 12.0, 1e-9);
  EXPECT_EQ(errors->are_first_pose_deg.median, 0.0);
}

TEST(TrajectoryErrors, AWrongFirstPoseShowsOnlyInFirstPoseAlignment) {
  const Trajectory reference = winding_path();
  Trajectory estimate = reference;
  Eigen::Matrix3d& first = estimate[0].world_from_camera.rotation;
  first = first * geometry::so3_exp({5 * kDegree, 0, 0});
  const auto errors = evaluate_trajectory(estimate, reference);
  EXPECT_NEAR(errors->are_first_pose_deg.mean, 5.0 * 100.0 / 101.0, 1e-9);
  EXPECT_LT(errors->are_aligned_deg.mean, 0.11);
}

TEST(TrajectoryErrors, AlignedRotationErrorsOfTwoHalves) {
  // Half the poses turned by +4 degrees and half by -4 about the same world axis: the mean is in the middle.
  Trajectory reference = winding_path(100), estimate = reference;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const double angle = (i % 2 == 0 ? 4.0 : -4.0) * kDegree;
    estimate[i].world_from_camera.rotation = geometry::so3_exp({0, 0, angle}) * estimate[i].world_from_camera.rotation;
  }
  const auto errors = evaluate_trajectory(estimate, reference);
  EXPECT_NEAR(errors->are_aligned_deg.mean, 4.0, 1e-9);
  EXPECT_NEAR(errors->are_aligned_deg.max, 4.0, 1e-9);
  EXPECT_NEAR(errors->are_first_pose_deg.mean, 4.0, 1e-9);
  EXPECT_NEAR(errors->are_first_pose_deg.max, 8.0, 1e-9);
}

TEST(TrajectoryErrors, RelativeErrorsOfAConstantDrift) {
  // A camera that stands still, and an estimate that drifts 2 cm and half a degree per second.
  Trajectory reference, estimate;
  for (int i = 0; i <= 90; ++i) {
    const double t = i / 30.0;
    reference.push_back({t, {}});
    estimate.push_back({t, {geometry::so3_exp({0, 0, 0.5 * kDegree * t}), {0, 0, 0.02 * t}}});
  }
  const auto errors = evaluate_trajectory(estimate, reference);
  EXPECT_EQ(errors->rpe_translation_m.count, 61U);
  EXPECT_NEAR(errors->rpe_translation_m.rmse, 0.02, 1e-12);
  EXPECT_NEAR(errors->rpe_rotation_deg.rmse, 0.5, 1e-9);
}

TEST(TrajectoryErrors, ShortTrajectoriesHaveNoRelativeErrors) {
  const auto errors = evaluate_trajectory(winding_path(5), winding_path(5));
  EXPECT_EQ(errors->rpe_translation_m.count, 0U);
  EXPECT_EQ(errors->rpe_translation_m.rmse, 0.0);
}

TEST(TrajectoryErrors, MatchingByTime) {
  const Trajectory reference = {{1.00, {}}, {1.03, {}}, {1.06, {}}};
  Trajectory estimate = {{0.5, {}}, {0.99, {}}, {1.01, {}}, {1.05, {}}, {1.081, {}}};
  const auto pairs = match_by_time(estimate, reference, 0.02);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_EQ(pairs[0].time_s, 0.99);
  EXPECT_EQ(pairs[1].time_s, 1.01);
  EXPECT_EQ(pairs[2].time_s, 1.05);
  EXPECT_TRUE(match_by_time({}, reference, 0.02).empty());
  EXPECT_TRUE(match_by_time(estimate, {}, 0.02).empty());
}

TEST(TrajectoryErrors, TooFewMatchesAreAnError) {
  const Trajectory reference = winding_path();
  Trajectory later = reference;
  for (StampedPose& pose : later) pose.time_s += 1000.0;
  EXPECT_EQ(evaluate_trajectory(later, reference).error().message,
            "only 0 of 101 estimated poses have a reference pose within 20 ms; at least 2 are needed");
  EXPECT_FALSE(evaluate_trajectory({}, reference).has_value());
  EXPECT_FALSE(evaluate_trajectory(reference, {}).has_value());
}

TEST(TrajectoryErrors, AHoleLowersTheCoverage) {
  const Trajectory reference = winding_path();
  Trajectory estimate = reference;
  estimate.erase(estimate.begin() + 21, estimate.begin() + 40);
  const auto errors = evaluate_trajectory(estimate, reference);
  EXPECT_EQ(errors->matched_poses, 82U);
  EXPECT_NEAR(errors->coverage, 0.8, 1e-9);
}

TEST(Statistics, QuantilesAndWeights) {
  const std::vector<double> errors = {4, 1, 3, 2};
  const ErrorStatistics s = statistics_of(errors);
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
  EXPECT_EQ(s.median, 2);
  EXPECT_EQ(s.p95, 4);
  EXPECT_EQ(s.max, 4);

  const std::vector<WeightedError> weighted = {{10, 1}, {1, 98}, {5, 1}};
  EXPECT_EQ(statistics_of(weighted).median, 1);
  EXPECT_EQ(statistics_of(weighted).p95, 1);
  EXPECT_DOUBLE_EQ(statistics_of(weighted).mean, 1.13);
  EXPECT_DOUBLE_EQ(share_within(weighted, 5.0), 0.99);
  EXPECT_DOUBLE_EQ(share_within(weighted, 0.9), 0.0);
  EXPECT_EQ(statistics_of(std::vector<WeightedError>{}).count, 0U);
  EXPECT_EQ(share_within({}, 1.0), 0.0);
}

}  // namespace
}  // namespace eg::eval
