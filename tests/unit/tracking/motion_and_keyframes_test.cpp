#include <gtest/gtest.h>

#include "common/tracking/keyframe_policy.hpp"
#include "common/tracking/motion_model.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::tracking {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

constexpr std::int64_t kFrame = 33'333;  // microseconds

constexpr bool kTranslationMeasured = true;

double distance(const Pose& a, const Pose& b) {
  return geometry::rotation_angle_between(a.rotation, b.rotation) + (a.translation - b.translation).norm();
}

TEST(MotionModel, ContinuesAConstantMotion) {
  base::Random random(1);
  const Pose step{geometry::so3_exp({0.01, 0.03, -0.02}), {0.02, -0.01, 0.03}};
  const Pose start = test::random_pose(random);
  MotionModel motion;
  motion.reset(0, start);
  EXPECT_LT(distance(motion.predict(kFrame).camera_from_world, start), 1e-12) << "no velocity yet";
  motion.update(kFrame, step * start, kTranslationMeasured);
  EXPECT_LT(distance(motion.predict(2 * kFrame).camera_from_world, step * step * start), 1e-9);
}

TEST(MotionModel, ScalesWithTheTimeThatPasses) {
  MotionModel motion;
  motion.reset(0, Pose{});
  motion.update(kFrame, {geometry::so3_exp({0, 0.02, 0}), Vector3d::Zero()}, kTranslationMeasured);
  const MotionPrior once = motion.predict(2 * kFrame);
  const MotionPrior twice = motion.predict(3 * kFrame);
  EXPECT_NEAR(geometry::so3_log(twice.camera_from_world.rotation).y(), 0.06, 1e-9);
  EXPECT_NEAR(twice.rotation_sigma, 2.0 * once.rotation_sigma, 1e-9);
  EXPECT_NEAR(twice.translation_sigma, 2.0 * once.translation_sigma, 1e-9);
}

TEST(MotionModel, ALongGapSaysNothing) {
  MotionModel motion;
  motion.reset(0, Pose{});
  const Pose last{geometry::so3_exp({0, 0.02, 0}), {0.1, 0, 0}};
  motion.update(kFrame, last, kTranslationMeasured);
  EXPECT_LT(distance(motion.predict(kFrame + 1'000'000).camera_from_world, last), 1e-12);
}

TEST(MotionModel, UnknownTranslationStops) {
  MotionModel motion;
  motion.reset(0, Pose{});
  motion.update(kFrame, {geometry::so3_exp({0, 0.02, 0}), {0.1, 0, 0}}, !kTranslationMeasured);
  const Pose next = motion.predict(2 * kFrame).camera_from_world;
  EXPECT_NEAR(geometry::so3_log(next.rotation).y(), 0.04, 1e-9) << "it turns on";
  const Vector3d turned = geometry::so3_exp({0, 0.02, 0}) * Vector3d(0.1, 0, 0);
  EXPECT_LT((next.translation - turned).norm(), 1e-9) << "about its own centre";
}

TEST(MotionModel, WhatIsNotMeasuredGrowsMoreUncertainFromFrameToFrame) {
  MotionModel motion;
  motion.reset(0, Pose{});
  motion.update(kFrame, Pose{}, kTranslationMeasured);
  const MotionPrior certain = motion.predict(2 * kFrame);
  double last = certain.translation_sigma;
  for (int frame = 2; frame < 10; ++frame) {
    motion.update(frame * kFrame, Pose{}, !kTranslationMeasured);
    const MotionPrior prior = motion.predict((frame + 1) * kFrame);
    EXPECT_GT(prior.translation_sigma, last);
    EXPECT_NEAR(prior.rotation_sigma, certain.rotation_sigma, 1e-12);
    last = prior.translation_sigma;
  }
  EXPECT_NEAR(last, 3.0 * certain.translation_sigma, 1e-9) << "nine steps: the square root of nine";
  motion.update(10 * kFrame, Pose{}, kTranslationMeasured);
  EXPECT_NEAR(motion.predict(11 * kFrame).translation_sigma, certain.translation_sigma, 1e-12);
}

TEST(MotionModel, ResetForgetsTheVelocity) {
  const Pose elsewhere{geometry::so3_exp({0.5, 0, 0}), {1, 2, 3}};
  MotionModel motion;
  motion.reset(0, Pose{});
  motion.update(kFrame, {geometry::so3_exp({0, 0.02, 0}), {0.01, 0, 0}}, !kTranslationMeasured);
  motion.reset(kFrame, elsewhere);
  const MotionPrior prior = motion.predict(2 * kFrame);
  EXPECT_LT(distance(prior.camera_from_world, elsewhere), 1e-12);
  MotionModel fresh;
  fresh.reset(kFrame, elsewhere);
  EXPECT_EQ(prior.rotation_sigma, fresh.predict(2 * kFrame).rotation_sigma);
}

TEST(MotionModel, TwoFramesAtOnceAreNoDivisionByZero) {
  MotionModel motion;
  motion.reset(0, Pose{});
  motion.update(0, {Eigen::Matrix3d::Identity(), {1, 0, 0}}, kTranslationMeasured);
  const MotionPrior prior = motion.predict(0);
  EXPECT_TRUE(prior.camera_from_world.translation.allFinite());
  EXPECT_GT(prior.rotation_sigma, 0.0);
  EXPECT_GT(prior.translation_sigma, 0.0);
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
