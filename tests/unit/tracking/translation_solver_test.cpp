#include "common/tracking/translation_solver.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/random_geometry.hpp"

namespace eg::tracking {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Pose;

class TranslationSolver : public testing::TestWithParam<const char*> {
 protected:
  PointFactor seen_point(const Pose& camera_from_world, bool depth, double noise = 0.0) {
    const Vector3d in_camera = camera_.unproject(
        {random_.uniform(0, camera_.width), random_.uniform(0, camera_.height)}, random_.uniform(0.8, 4.0));
    PointFactor factor{camera_from_world.inverse() * in_camera, camera_.project(in_camera), 1.0};
    factor.pixel += noise * Vector2d(random_.normal(), random_.normal());
    factor.depth_sigma = 0.01;
    if (depth) factor.depth = in_camera.z() + noise * 0.01 * random_.normal();
    return factor;
  }

  base::Random random_{1};
  geometry::CameraModel camera_ = *geometry::find_camera(GetParam());
};

TEST_P(TranslationSolver, TwoCorrespondencesAreEnough) {
  for (int trial = 0; trial < 500; ++trial) {
    const Pose truth = test::random_pose(random_);
    const bool depth = trial % 2 == 0;
    const std::vector<PointFactor> two = {seen_point(truth, depth), seen_point(truth, depth)};
    const auto translation = solve_translation(two, camera_, truth.rotation);
    if (!translation) {
      EXPECT_LT((two[0].pixel - two[1].pixel).norm(), 10.0) << "nearly one ray";
      continue;
    }
    EXPECT_LT((*translation - truth.translation).norm(), 1e-8);
  }
}

TEST_P(TranslationSolver, OnePointWithDepthIsEnoughForTheEquations) {
  const Pose truth = test::random_pose(random_);
  const std::vector<PointFactor> one = {seen_point(truth, true)};
  const auto translation = solve_translation(one, camera_, truth.rotation);
  ASSERT_TRUE(translation.has_value());
  EXPECT_LT((*translation - truth.translation).norm(), 1e-9);
}

TEST_P(TranslationSolver, UndeterminedGivesNothing) {
  const Pose truth = test::random_pose(random_);
  EXPECT_FALSE(solve_translation({}, camera_, truth.rotation).has_value());
  const PointFactor without_depth = seen_point(truth, false);
  EXPECT_FALSE(solve_translation(std::vector{without_depth}, camera_, truth.rotation).has_value());
  EXPECT_FALSE(solve_translation(std::vector{without_depth, without_depth}, camera_, truth.rotation).has_value())
      << "twice the same ray";
}

TEST_P(TranslationSolver, ConsensusFindsTheRightHalf) {
  for (int trial = 0; trial < 50; ++trial) {
    const Pose truth = test::random_pose(random_);
    std::vector<PointFactor> factors;
    for (int i = 0; i < 60; ++i) factors.push_back(seen_point(truth, i % 3 != 0, 1.0));
    for (std::size_t i = 0; i < 24; ++i) factors[i].pixel = {random_.uniform(0, 640), random_.uniform(0, 480)};
    const auto estimate = estimate_translation(factors, camera_, truth.rotation);
    ASSERT_TRUE(estimate.has_value());
    EXPECT_LT((estimate->translation - truth.translation).norm(), 0.03);
    ASSERT_EQ(estimate->inliers.size(), factors.size());
    EXPECT_EQ(estimate->inlier_count, std::count(estimate->inliers.begin(), estimate->inliers.end(), true));
    EXPECT_GT(estimate->inlier_count, 24);
    EXPECT_LT(std::count(estimate->inliers.begin(), estimate->inliers.begin() + 24, true), 3);
  }
}

TEST_P(TranslationSolver, TooFewThatAgreeGiveNothing) {
  const Pose truth = test::random_pose(random_);
  std::vector<PointFactor> factors;
  EXPECT_FALSE(estimate_translation(factors, camera_, truth.rotation).has_value());
  factors = {seen_point(truth, true)};
  EXPECT_FALSE(estimate_translation(factors, camera_, truth.rotation).has_value());
  factors.push_back(seen_point(truth, true));
  EXPECT_FALSE(estimate_translation(factors, camera_, truth.rotation).has_value()) << "two agree with themselves";
  for (int i = 0; i < 10; ++i) {
    factors.push_back(seen_point(truth, true));
    factors.back().pixel = {random_.uniform(0, 640), random_.uniform(0, 480)};
    factors.back().depth = random_.uniform(0.8, 4.0);
  }
  EXPECT_FALSE(estimate_translation(factors, camera_, truth.rotation, {.min_inliers = 6}).has_value());
}

TEST_P(TranslationSolver, ConsensusIsRepeatable) {
  const Pose truth = test::random_pose(random_);
  std::vector<PointFactor> factors;
  for (int i = 0; i < 40; ++i) factors.push_back(seen_point(truth, true, 1.0));
  const auto first = estimate_translation(factors, camera_, truth.rotation);
  const auto second = estimate_translation(factors, camera_, truth.rotation);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->translation, second->translation);
}

INSTANTIATE_TEST_SUITE_P(Cameras, TranslationSolver, testing::Values("tum_fr3", "icl"),
                         [](const auto& camera) { return std::string(camera.param); });

}  // namespace
}  // namespace eg::tracking
