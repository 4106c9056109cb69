#include <gtest/gtest.h>

#include "common/tracking/keyframe_policy.hpp"
#include "common/tracking/motion_model.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::tracking {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

constexpr std::int64_t kFrame = 33'333;  // microseconds

/// A millimetre and a milliradian in all directions.
const Matrix6d kSharp = 1e6 * Matrix6d::Identity();

Matrix6d rotation_only() {
  Matrix6d information = kSharp;
  information.bottomRightCorner<3, 3>().setZero();
  return information;
}

MotionPrior exactly(const Pose& pose) { return known_within(pose, 0.0, 0.0); }

double distance(const Pose& a, const Pose& b) {
  return geometry::rotation_angle_between(a.rotation, b.rotation) + (a.translation - b.translation).norm();
}

TEST(MotionModel, ContinuesAConstantMotion) {
  base::Random random(1);
  const Pose step{geometry::so3_exp({0.01, 0.03, -0.02}), {0.02, -0.01, 0.03}};
  const Pose start = test::random_pose(random);
  MotionModel motion;
  motion.reset(0, exactly(start));
  EXPECT_LT(distance(motion.predict(kFrame).camera_from_world, start), 1e-12) << "no velocity yet";
  Pose pose = start;
  for (int frame = 1; frame < 30; ++frame) {
    pose = step * pose;
    motion.update(frame * kFrame, pose, kSharp);
  }
  EXPECT_LT(distance(motion.predict(30 * kFrame).camera_from_world, step * pose), 0.1 * distance(step, Pose{}));
}

TEST(MotionModel, ScalesWithTheTimeThatPasses) {
  MotionModel motion;
  motion.reset(0, exactly(Pose{}));
  motion.update(kFrame, {geometry::so3_exp({0, 0.02, 0}), Vector3d::Zero()}, kSharp);
  const double once = geometry::so3_log(motion.predict(2 * kFrame).camera_from_world.rotation).y() - 0.02;
  const double twice = geometry::so3_log(motion.predict(3 * kFrame).camera_from_world.rotation).y() - 0.02;
  EXPECT_GT(once, 0.015);
  EXPECT_NEAR(twice, 2.0 * once, 1e-6);
  EXPECT_GT(motion.predict(3 * kFrame).rotation_sigma(), 1.9 * motion.predict(2 * kFrame).rotation_sigma());
}

TEST(MotionModel, ALongGapSaysNothing) {
  MotionModel motion;
  motion.reset(0, exactly(Pose{}));
  const Pose last{geometry::so3_exp({0, 0.02, 0}), {0.1, 0, 0}};
  motion.update(kFrame, last, kSharp);
  EXPECT_LT(distance(motion.predict(kFrame + 1'000'000).camera_from_world, last), 1e-12);
}

/// The covariance is that of the error: a camera whose velocity does what the model says, seen through noise.
TEST(MotionModel, PredictsAsWellAsItSays) {
  base::Random random(2);
  constexpr double kTurnNoise = 0.004;
  constexpr double kWayNoise = 0.02;
  const MotionOptions options;
  const double seconds = 1e-6 * kFrame;
  const double fading = std::exp(-seconds / options.memory_s);
  Matrix6d information = Matrix6d::Identity() / (kTurnNoise * kTurnNoise);
  information.bottomRightCorner<3, 3>() = Eigen::Matrix3d::Identity() / (kWayNoise * kWayNoise);
  double sum = 0.0;
  int frames = 0;
  for (int run = 0; run < 40; ++run) {
    Pose truth;
    Vector6d velocity;
    velocity << test::normal_vector(random, options.angular_speed), test::normal_vector(random, options.speed);
    MotionModel motion(options);
    motion.reset(0, exactly(truth));
    for (int frame = 1; frame <= 50; ++frame) {
      Vector6d change;
      change << test::normal_vector(random, options.angular_velocity_change),
          test::normal_vector(random, options.velocity_change);
      velocity += change;
      truth = Pose{geometry::so3_exp(seconds * velocity.head<3>()), seconds * velocity.tail<3>()} * truth;
      velocity *= fading;
      const MotionPrior prior = motion.predict(frame * kFrame);
      const Vector6d error = pose_difference(prior.camera_from_world, truth);
      sum += error.dot(prior.covariance.inverse() * error);
      ++frames;
      Vector6d noise;
      noise << test::normal_vector(random, kTurnNoise), test::normal_vector(random, kWayNoise);
      const Vector6d innovation = pose_difference(prior.camera_from_world, perturb(truth, noise));
      const Matrix6d posterior = (prior.covariance.inverse() + information).inverse();
      motion.update(frame * kFrame, perturb(prior.camera_from_world, posterior * information * innovation),
                    information);
    }
  }
  EXPECT_NEAR(sum / frames, 6.0, 0.6) << "six unknowns";
}

TEST(MotionModel, AWeakMeasurementHardlyChangesTheVelocity) {
  MotionModel motion;
  motion.reset(0, exactly(Pose{}));
  const Vector3d way(0.01, 0, 0);
  Pose pose;
  for (int frame = 1; frame < 20; ++frame) {
    pose.translation += way;
    motion.update(frame * kFrame, pose, kSharp);
  }
  // It goes on, though a measurement good to a metre said otherwise.
  motion.update(20 * kFrame, {pose.rotation, pose.translation + way}, Matrix6d::Identity());
  const Pose next = motion.predict(21 * kFrame).camera_from_world;
  EXPECT_NEAR((next.translation - pose.translation).x(), 2.0 * way.x(), 0.3 * way.x());
}

TEST(MotionModel, WhatIsNotMeasuredGrowsMoreUncertainAndComesToRest) {
  MotionModel motion;
  motion.reset(0, exactly(Pose{}));
  motion.update(kFrame, {Eigen::Matrix3d::Identity(), {0.01, 0, 0}}, kSharp);
  const double turn = motion.predict(2 * kFrame).rotation_sigma();
  double last = motion.predict(2 * kFrame).translation_sigma();
  for (int frame = 2; frame < 120; ++frame) {
    motion.update(frame * kFrame, motion.predict(frame * kFrame).camera_from_world, rotation_only());
    const MotionPrior prior = motion.predict((frame + 1) * kFrame);
    EXPECT_GT(prior.translation_sigma(), last);
    EXPECT_LT(prior.rotation_sigma(), 1.1 * turn) << "it is measured";
    last = prior.translation_sigma();
  }
  const double x = motion.predict(121 * kFrame).camera_from_world.translation.x();
  const double later = motion.predict(121 * kFrame + 100'000).camera_from_world.translation.x();
  EXPECT_NEAR(later, x, 1e-4);
  motion.update(122 * kFrame, Pose{}, kSharp);
  EXPECT_LT(motion.predict(123 * kFrame).translation_sigma(), 0.1 * last);
}

TEST(MotionModel, ResetForgetsTheVelocity) {
  const Pose elsewhere{geometry::so3_exp({0.5, 0, 0}), {1, 2, 3}};
  MotionModel motion;
  motion.reset(0, exactly(Pose{}));
  motion.update(kFrame, {geometry::so3_exp({0, 0.02, 0}), {0.01, 0, 0}}, kSharp);
  motion.reset(kFrame, exactly(elsewhere));
  const MotionPrior prior = motion.predict(2 * kFrame);
  EXPECT_LT(distance(prior.camera_from_world, elsewhere), 1e-12);
  MotionModel fresh;
  fresh.reset(kFrame, exactly(elsewhere));
  EXPECT_EQ(prior.covariance, fresh.predict(2 * kFrame).covariance);
}

TEST(MotionModel, TwoFramesAtOnceAreNoDivisionByZero) {
  MotionModel motion;
  motion.reset(0, exactly(Pose{}));
  motion.update(0, {Eigen::Matrix3d::Identity(), {1, 0, 0}}, kSharp);
  const MotionPrior prior = motion.predict(0);
  EXPECT_TRUE(prior.camera_from_world.translation.allFinite());
  EXPECT_GT(prior.rotation_sigma(), 0.0);
  EXPECT_GT(prior.translation_sigma(), 0.0);
}

/// Explicit, so that the rules are tested and not the figures.
constexpr KeyframeOptions kRules{.max_frames = 20,
                                 .min_tracked_ratio = 0.85,
                                 .min_tracked_ratio_of_many = 0.7,
                                 .many_features = 200,
                                 .min_frames = 3,
                                 .new_structure_frames = 2};

/// How many frames pass until a keyframe is wanted, at most 100.
int frames_until_keyframe(KeyframePolicy& policy, int tracked) {
  for (int frame = 1; frame <= 100; ++frame) {
    if (policy.wants_keyframe(tracked, false)) return frame;
  }
  return 100;
}

TEST(KeyframePolicy, TwentyFramesAfterTheLastAsInThePaper) {
  KeyframePolicy policy;
  EXPECT_EQ(frames_until_keyframe(policy, 500), 20);
  policy.keyframe_added();
  EXPECT_EQ(frames_until_keyframe(policy, 500), 20);
}

TEST(KeyframePolicy, WhenTooFewOfTheLastOnesFeaturesAreTracked) {
  KeyframePolicy policy(kRules);
  for (int frame = 0; frame < 5; ++frame) EXPECT_FALSE(policy.wants_keyframe(100, false));
  EXPECT_FALSE(policy.wants_keyframe(86, false));
  EXPECT_TRUE(policy.wants_keyframe(84, false));
}

TEST(KeyframePolicy, WhereManyFeaturesAreInViewMoreOfThemMayGo) {
  KeyframePolicy policy(kRules);
  for (int frame = 0; frame < 5; ++frame) EXPECT_FALSE(policy.wants_keyframe(1000, false));
  EXPECT_FALSE(policy.wants_keyframe(701, false));
  EXPECT_TRUE(policy.wants_keyframe(699, false));
}

TEST(KeyframePolicy, WhenNewStructureIsSeenInTwoFramesInARow) {
  KeyframePolicy policy(kRules);
  for (int frame = 0; frame < 5; ++frame) EXPECT_FALSE(policy.wants_keyframe(100, false));
  EXPECT_FALSE(policy.wants_keyframe(100, true)) << "one frame may be mistaken";
  EXPECT_FALSE(policy.wants_keyframe(100, false));
  EXPECT_FALSE(policy.wants_keyframe(100, true));
  EXPECT_TRUE(policy.wants_keyframe(100, true));
}

TEST(KeyframePolicy, NeverTooSoon) {
  KeyframePolicy policy(kRules);
  EXPECT_FALSE(policy.wants_keyframe(100, true));
  EXPECT_FALSE(policy.wants_keyframe(1, true));
  EXPECT_TRUE(policy.wants_keyframe(1, true));
  policy.keyframe_added();
  EXPECT_FALSE(policy.wants_keyframe(0, true));
}

TEST(KeyframePolicy, WithoutAnyFeaturesOnlyFramesCount) {
  // White walls: there is nothing to lose.
  KeyframePolicy policy(kRules);
  EXPECT_EQ(frames_until_keyframe(policy, 0), 20);
}

}  // namespace
}  // namespace eg::tracking
