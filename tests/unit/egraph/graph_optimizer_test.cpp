#include "common/egraph/graph_optimizer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/egraph/graph_residuals.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::egraph {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geometry::Pose;
using test::kDegree;

constexpr double kDirectionSigma = 0.3 * kDegree;
constexpr double kRotationSigma = 0.2 * kDegree;  // of a relative pose
constexpr double kTranslationSigma = 0.004;       // metres

Matrix6d relative_covariance(double scale = 1.0) {
  Eigen::Matrix<double, 6, 1> variances;
  variances << Vector3d::Constant(kRotationSigma * kRotationSigma),
      Vector3d::Constant(kTranslationSigma * kTranslationSigma);
  return scale * scale * variances.asDiagonal().toDenseMatrix();
}

/// A walk along a corridor: relative poses between neighbours, and three walls that every keyframe sees.
struct World {
  std::vector<Pose> truth;
  std::vector<Vector3d> directions = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d(1, 0.2, 1).normalized()};
  GraphSnapshot graph;

  World(int keyframes, base::Random& random, double noise) {
    graph.session = 1;
    graph.version = keyframes;
    for (int i = 0; i < keyframes; ++i) {
      truth.push_back({geometry::so3_exp({0.1 * std::sin(0.3 * i), 0.2 * i, 0}), {0.3 * i, 0.1 * std::sin(i), 0}});
      add_keyframe(i, random, noise);
    }
    for (int l = 0; l < static_cast<int>(directions.size()); ++l) add_landmark(l, keyframes, random, noise);
  }

  Graph make() const {
    Graph made;
    EXPECT_TRUE(made.reset(graph).has_value());
    return made;
  }

  void add_keyframe(int i, base::Random& random, double noise) {
    const auto index = static_cast<std::size_t>(i);
    Pose pose = truth[index];
    if (i > 0) {
      const Pose relative = truth[index - 1].inverse() * truth[index];
      const Pose measured{geometry::so3_exp(test::normal_vector(random, noise * kRotationSigma)) * relative.rotation,
                          relative.translation + test::normal_vector(random, noise * kTranslationSigma)};
      graph.relative_poses.push_back({KeyframeId{i - 1}, KeyframeId{i}, measured, relative_covariance()});
      pose = graph.keyframes.back().world_from_camera * measured;  // dead reckoning
    }
    graph.keyframes.push_back({KeyframeId{i}, 10 * i, 1000 * i, pose, Matrix6d::Identity()});
    for (int l = 0; l < static_cast<int>(directions.size()); ++l) {
      Vector3d seen = truth[index].rotation.transpose() * directions[static_cast<std::size_t>(l)];
      if (noise > 0) seen = test::disturbed_direction(seen, noise * kDirectionSigma, random);
      graph.observations.push_back(
          {KeyframeId{i}, LandmarkId{l}, seen, test::tangential_covariance(seen, kDirectionSigma)});
    }
  }

  void add_landmark(int l, int keyframes, base::Random& random, double noise) {
    Vector3d direction = truth[0].rotation * graph.observations[static_cast<std::size_t>(l)].direction_in_camera;
    if (noise == 0) direction = test::disturbed_direction(direction, 1.0 * kDegree, random);
    graph.landmarks.push_back({LandmarkId{l}, DirectionKind::plane_normal, direction,
                               test::tangential_covariance(direction, kDirectionSigma), keyframes, KeyframeId{0},
                               KeyframeId{keyframes - 1}});
  }
};

struct Errors {
  double rotation = 0.0;     ///< radians, root mean square
  double translation = 0.0;  ///< metres
};

Errors errors(const Graph& graph, const World& world) {
  Errors sum;
  for (std::size_t i = 0; i < world.truth.size(); ++i) {
    const Pose& pose = graph.keyframes()[i].world_from_camera;
    sum.rotation += std::pow(geometry::rotation_angle_between(pose.rotation, world.truth[i].rotation), 2);
    sum.translation += (pose.translation - world.truth[i].translation).squaredNorm();
  }
  const auto count = static_cast<double>(world.truth.size());
  return {std::sqrt(sum.rotation / count), std::sqrt(sum.translation / count)};
}

Graph optimized(const World& world, const GraphOptimizerOptions& options) {
  Graph graph = world.make();
  const GraphCorrections corrections = optimize_graph(graph, options);
  EXPECT_LE(corrections.final_cost, corrections.initial_cost);
  graph.refine(corrections.keyframes, corrections.landmarks);
  return graph;
}

constexpr GraphOptimizerOptions kRotations{.refine = Refinement::rotations};
constexpr GraphOptimizerOptions kPoses{.refine = Refinement::poses};

TEST(GraphResiduals, JacobiansOfADirection) {
  base::Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Matrix3d rotation = test::random_rotation(random);
    const Vector3d landmark = test::random_direction(random);
    const Vector3d seen = rotation.transpose() * test::disturbed_direction(landmark, 0.05, random);
    const DirectionResidual at(rotation, landmark, seen, Matrix3d::Identity(), 0.001);
    const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(landmark);
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 3; ++i) {
      const Matrix3d moved = geometry::so3_exp(kStep * Vector3d::Unit(i)) * rotation;
      const Eigen::Vector2d slope = (basis.transpose() * (moved * seen) - at.value) / kStep;
      EXPECT_LT((slope - at.by_rotation.col(i)).norm(), 1e-5);
    }
    for (int i = 0; i < 2; ++i) {
      const Vector3d moved = (landmark + kStep * basis.col(i)).normalized();
      const Eigen::Vector2d slope = (basis.transpose() * (rotation * seen - moved) - at.value) / kStep;
      EXPECT_LT((slope - at.by_direction.col(i)).norm(), 1e-5);
    }
  }
}

TEST(GraphResiduals, JacobiansOfARelativePose) {
  base::Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const Pose first = test::random_pose(random);
    const Pose second = test::random_pose(random);
    const Pose error{geometry::so3_exp(test::normal_vector(random, trial % 2 == 0 ? 0.3 : 1e-6)),
                     test::normal_vector(random, 0.1)};
    const RelativePose measured{KeyframeId{0}, KeyframeId{1}, error * (first.inverse() * second),
                                relative_covariance()};
    const RelativePoseResidual at(first, second, measured);
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 6; ++i) {
      const auto moved = [&](const Pose& pose) -> Pose {
        const Vector3d step = kStep * Vector3d::Unit(i % 3);
        return i < 3 ? Pose{geometry::so3_exp(step) * pose.rotation, pose.translation}
                     : Pose{pose.rotation, pose.translation + step};
      };
      const Eigen::Matrix<double, 6, 1> slope_first =
          (RelativePoseResidual(moved(first), second, measured).value - at.value) / kStep;
      const Eigen::Matrix<double, 6, 1> slope_second =
          (RelativePoseResidual(first, moved(second), measured).value - at.value) / kStep;
      EXPECT_LT((slope_first - at.by_first.col(i)).norm(), 1e-4) << i;
      EXPECT_LT((slope_second - at.by_second.col(i)).norm(), 1e-4) << i;
    }
  }
}

TEST(GraphOptimizer, FindsTheTruthOfExactMeasurements) {
  base::Random random(3);
  World world(12, random, 0.0);
  for (std::size_t i = 1; i < world.graph.keyframes.size(); ++i) {
    Pose& pose = world.graph.keyframes[i].world_from_camera;
    pose.rotation = geometry::so3_exp(test::normal_vector(random, 0.03)) * pose.rotation;
    pose.translation += test::normal_vector(random, 0.1);
  }
  const Graph poses = optimized(world, {.refine = Refinement::poses, .max_iterations = 50});
  EXPECT_LT(errors(poses, world).rotation, 1e-6);
  EXPECT_LT(errors(poses, world).translation, 1e-6);
  for (std::size_t l = 0; l < world.directions.size(); ++l) {
    EXPECT_LT(geometry::axial_angle(poses.landmarks()[l].direction, world.directions[l]), 1e-6);
  }
  const Graph rotations = optimized(world, {.refine = Refinement::rotations, .max_iterations = 50});
  EXPECT_LT(errors(rotations, world).rotation, 1e-6);
}

TEST(GraphOptimizer, DirectionsStopTheDriftOfRotationAndWithItThatOfPositions) {
  double drifting = 0.0;
  double straightened = 0.0;
  double turned = 0.0;
  double averaged = 0.0;
  for (int seed = 0; seed < 5; ++seed) {
    base::Random random(10 + static_cast<std::uint64_t>(seed));
    const World world(150, random, 1.0);
    const Graph before = world.make();
    const Graph rotations = optimized(world, kRotations);
    const Graph poses = optimized(world, kPoses);
    turned += errors(before, world).rotation;
    averaged += errors(rotations, world).rotation;
    drifting += errors(before, world).translation;
    straightened += errors(poses, world).translation;
    EXPECT_LT(errors(poses, world).rotation, 1.0 * kDegree);
  }
  // The frame is the first keyframe's, known by three directions: 0.3° / sqrt(2) about each axis.
  EXPECT_LT(averaged / 5, 0.5 * kDegree);
  EXPECT_LT(averaged, 0.25 * turned);
  EXPECT_LT(straightened, 0.4 * drifting);
}

TEST(GraphOptimizer, WrongAssociationsChangeLittle) {
  base::Random random(4);
  World world(60, random, 1.0);
  const double clean = errors(optimized(world, kPoses), world).rotation;
  for (std::size_t i = 5; i < world.graph.observations.size(); i += 10) {
    Vector3d& seen = world.graph.observations[i].direction_in_camera;
    seen = geometry::so3_exp(4.0 * kDegree * test::random_direction(random)) * seen;
  }
  EXPECT_LT(errors(optimized(world, kPoses), world).rotation, clean + 0.05 * kDegree);
}

TEST(GraphOptimizer, TheFirstKeyframeIsTheGauge) {
  base::Random random(5);
  const World world(40, random, 1.0);
  for (const auto& options : {kRotations, kPoses}) {
    const Graph graph = optimized(world, options);
    EXPECT_EQ(graph.keyframes()[0].world_from_camera.rotation, world.truth[0].rotation);
    EXPECT_EQ(graph.keyframes()[0].world_from_camera.translation, world.truth[0].translation);
  }
}

TEST(GraphOptimizer, RotationAveragingLeavesPositionsAlone) {
  base::Random random(6);
  const World world(40, random, 1.0);
  const Graph before = world.make();
  const Graph after = optimized(world, kRotations);
  for (std::size_t i = 0; i < 40; ++i) {
    EXPECT_EQ(before.keyframes()[i].world_from_camera.translation, after.keyframes()[i].world_from_camera.translation);
  }
}

TEST(GraphOptimizer, HoldsKeyframesThatAreOlderThanItsWindow) {
  base::Random random(7);
  const World world(60, random, 1.0);
  const Graph before = world.make();
  const Graph after = optimized(world, {.refine = Refinement::poses, .max_keyframes = 20});
  for (std::size_t i = 0; i < 40; ++i) {
    EXPECT_EQ(before.keyframes()[i].world_from_camera.rotation, after.keyframes()[i].world_from_camera.rotation);
  }
  EXPECT_NE(before.keyframes()[59].world_from_camera.rotation, after.keyframes()[59].world_from_camera.rotation);
}

TEST(GraphOptimizer, WhatOlderKeyframesSawSaysWhereALandmarkIsNotWhoeverSawItLast) {
  base::Random random(10);
  World world(60, random, 0.1);
  for (std::size_t i = 1; i < 60; ++i) world.graph.keyframes[i].world_from_camera = world.truth[i];
  // Keyframe 40, the first that is refined, is hardly known, and wrongly, relative to those that are held.
  RelativePose& border = world.graph.relative_poses[39];
  border.first_from_second.rotation = geometry::so3_exp({0.0, 1.0 * kDegree, 0.0}) * border.first_from_second.rotation;
  border.covariance = relative_covariance(10.0);
  const Matrix3d turn = geometry::so3_exp({0.0, 2.0 * kDegree, 1.0 * kDegree});
  for (DirectionLandmark& landmark : world.graph.landmarks) landmark.direction = turn * landmark.direction;
  const Graph after = optimized(world, {.refine = Refinement::poses, .max_keyframes = 20});
  EXPECT_LT(errors(after, world).rotation, 0.05 * kDegree);
  for (std::size_t l = 0; l < world.directions.size(); ++l) {
    EXPECT_LT(geometry::axial_angle(after.landmarks()[l].direction, world.directions[l]), 0.05 * kDegree);
  }
}

TEST(GraphOptimizer, IsDeterministicAndCanBeSwitchedOff) {
  base::Random random(8);
  const World world(50, random, 1.0);
  const Graph once = optimized(world, kPoses);
  const Graph twice = optimized(world, kPoses);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(once.keyframes()[i].world_from_camera.translation, twice.keyframes()[i].world_from_camera.translation);
  }
  EXPECT_TRUE(optimize_graph(world.make(), {.refine = Refinement::none}).keyframes.empty());
}

TEST(GraphOptimizer, KeyframesThatNothingIsKnownOfStay) {
  base::Random random(9);
  World world(10, random, 1.0);
  world.graph.keyframes.push_back({KeyframeId{10}, 100, 10'000, test::random_pose(random), Matrix6d::Identity()});
  const Graph before = world.make();
  const Graph after = optimized(world, kPoses);
  EXPECT_EQ(before.keyframes()[10].world_from_camera.translation, after.keyframes()[10].world_from_camera.translation);
  EXPECT_TRUE(after.keyframes()[5].world_from_camera.rotation.allFinite());
}

TEST(GraphOptimizer, IsDueAtBoundedDistances) {
  std::size_t last = 0;
  double work = 0.0;
  constexpr std::size_t kKeyframes = 20'000;
  for (std::size_t n = 1; n <= kKeyframes; ++n) {
    if (!optimization_is_due(n)) continue;
    EXPECT_LE(n - last, 128U + 64U);
    last = n;
    work += static_cast<double>(std::min<std::size_t>(n, 1000));
  }
  EXPECT_LT(work / kKeyframes, 20.0) << "keyframes refined per keyframe";
}

}  // namespace
}  // namespace eg::egraph
