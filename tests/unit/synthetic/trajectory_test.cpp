#include "common/synthetic/trajectory.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numbers>

#include "common/geometry/so3.hpp"

namespace eg::synthetic {
namespace {

constexpr double kFrame = 1.0 / 30.0;

class EveryTrajectory : public testing::TestWithParam<std::string> {
 protected:
  /// Rotation vector per second between two times, in the camera frame.
  [[nodiscard]] Eigen::Vector3d angular_velocity(double t, double step) const {
    const geometry::Pose a = trajectory_.world_from_camera(t);
    const geometry::Pose b = trajectory_.world_from_camera(t + step);
    return geometry::so3_log(a.rotation.transpose() * b.rotation) / step;
  }
  [[nodiscard]] Eigen::Vector3d velocity(double t, double step) const {
    return (trajectory_.world_from_camera(t + step).translation - trajectory_.world_from_camera(t).translation) / step;
  }

  Trajectory trajectory_ = *make_trajectory(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Trajectories, EveryTrajectory, testing::ValuesIn(trajectory_names()),
                         [](const auto& instance) { return instance.param; });

TEST_P(EveryTrajectory, IsSlowEnoughForAHandHeldCamera) {
  for (double t = 0; t < trajectory_.duration_s; t += kFrame) {
    EXPECT_LT(velocity(t, kFrame).norm(), 0.55);
    EXPECT_LT(angular_velocity(t, kFrame).norm(), 42.0 * std::numbers::pi / 180.0);
  }
}

TEST_P(EveryTrajectory, IsSmooth) {
  // Halving the step must halve the change of the velocities: they have a derivative.
  for (double t = 0; t < trajectory_.duration_s; t += 0.37) {
    for (const double step : {1e-3, 5e-4}) {
      EXPECT_LT((velocity(t + step, step) - velocity(t, step)).norm() / step, 1.5);
      EXPECT_LT((angular_velocity(t + step, step) - angular_velocity(t, step)).norm() / step, 2.0);
    }
  }
}

TEST_P(EveryTrajectory, StartsSomewhereThatIsNotTheIdentity) {
  const geometry::Pose first = trajectory_.world_from_camera(0.0);
  EXPECT_GT(first.translation.norm(), 0.1);
  EXPECT_GT(geometry::rotation_angle_between(first.rotation, Eigen::Matrix3d::Identity()), 0.1);
  EXPECT_NEAR(first.rotation.determinant(), 1.0, 1e-12);
}

TEST(Trajectory, CameraLooksAlongItsHeadingWithTheWorldsUpAbove) {
  Trajectory trajectory;
  trajectory.heading.offset = 0.5 * std::numbers::pi;
  geometry::Pose pose = trajectory.world_from_camera(0.0);
  EXPECT_NEAR((pose.rotation.col(2) - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-12) << "forward";
  EXPECT_NEAR((pose.rotation.col(0) - Eigen::Vector3d::UnitX()).norm(), 0.0, 1e-12) << "right";
  EXPECT_NEAR((pose.rotation.col(1) + Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-12) << "down";
  trajectory.tilt.offset = 0.3;
  pose = trajectory.world_from_camera(0.0);
  EXPECT_NEAR(pose.rotation(2, 2), -std::sin(0.3), 1e-12) << "tilting lowers the view";
}

TEST(Trajectory, SpinTurnsOnceOnTheSpot) {
  const Trajectory spin = *make_trajectory("spin");
  const geometry::Pose first = spin.world_from_camera(0.0);
  double turned = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double t = spin.duration_s * i / 1000.0;
    const geometry::Pose pose = spin.world_from_camera(t);
    EXPECT_EQ(pose.translation, first.translation);
    turned += spin.heading.at(t + spin.duration_s / 1000.0) - spin.heading.at(t);
  }
  EXPECT_NEAR(turned, 2.0 * std::numbers::pi, 1e-9);
}

TEST(Trajectory, UnknownNameIsAnError) { EXPECT_FALSE(make_trajectory("fall").has_value()); }

}  // namespace
}  // namespace eg::synthetic
