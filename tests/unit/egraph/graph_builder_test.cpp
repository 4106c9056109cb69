#include "common/egraph/graph_builder.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/support/random_geometry.hpp"

namespace eg::egraph {
namespace {

using enum DirectionKind;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::kDegree;
using test::tangential_covariance;

struct Seen {
  DirectionKind kind;
  Vector3d in_world;
  double sigma = 0.005;
};

const Seen kFloor{plane_normal, Vector3d::UnitY()};
const Seen kWall{plane_normal, Vector3d::UnitZ()};
const Seen kEdges{vanishing_direction, Vector3d::UnitX()};

/// A keyframe at `pose` that sees the given scene directions, disturbed by their noise if there is a generator.
Keyframe keyframe(int id, const geometry::Pose& pose, const std::vector<Seen>& seen, base::Random* random = nullptr,
                  double rotation_sigma = 0.001) {
  Keyframe result;
  result.header = {3, 10 * id, 1'000'000 + 100'000 * id};
  result.id = KeyframeId{id};
  result.world_from_camera = pose;
  result.covariance.topLeftCorner<3, 3>() = rotation_sigma * rotation_sigma * Matrix3d::Identity();
  for (const Seen& direction : seen) {
    Vector3d in_camera = pose.rotation.transpose() * direction.in_world;
    if (random != nullptr) in_camera = test::disturbed_direction(in_camera, direction.sigma, *random);
    result.directions.push_back(
        {direction.kind, in_camera, tangential_covariance(in_camera, direction.sigma), 100, -1});
    result.plane_distances.push_back(direction.kind == plane_normal ? 1.0 : std::nan(""));
  }
  return result;
}

Keyframe keyframe(int id, const std::vector<Seen>& seen) { return keyframe(id, geometry::Pose{}, seen); }

GraphUpdate add(GraphBuilder& builder, const Keyframe& keyframe) {
  const auto update = builder.add_keyframe(keyframe);
  EXPECT_TRUE(update.has_value()) << (update ? "" : update.error().message);
  return update.value_or(GraphUpdate{});
}

std::vector<Edge> edges_after(GraphBuilder& builder, const Keyframe& keyframe) {
  add(builder, keyframe);
  return builder.graph().edges_to_older(keyframe.id);
}

double largest_sigma(const Matrix3d& covariance) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).eigenvalues()[2]);
}

bool same(const GraphUpdate& a, const GraphUpdate& b) {
  return a.version == b.version && a.base_version == b.base_version && a.landmarks.size() == b.landmarks.size() &&
         a.removed == b.removed && a.observations.size() == b.observations.size() &&
         std::equal(a.landmarks.begin(), a.landmarks.end(), b.landmarks.begin(), [](const auto& l, const auto& m) {
           return l.id == m.id && l.direction == m.direction && l.covariance == m.covariance;
         });
}

TEST(GraphBuilder, TheFirstKeyframeInitialisesTheGraph) {
  base::Random random(1);
  const geometry::Pose pose = test::random_pose(random);
  GraphBuilder builder;
  const GraphUpdate update =
      add(builder, keyframe(0, pose, {kFloor, kWall, kEdges, {potential_direction, Vector3d(1, 1, 0).normalized()}}));
  EXPECT_EQ(update.session, 3);
  EXPECT_EQ(update.base_version, 0);
  EXPECT_EQ(update.version, 1);
  EXPECT_EQ(update.keyframe.id, KeyframeId{0});
  EXPECT_EQ(update.observations.size(), 4U);
  EXPECT_TRUE(builder.graph().edges_to_older(KeyframeId{0}).empty()) << "E_0 has no edges yet";
  ASSERT_EQ(update.landmarks.size(), 4U);
  const std::vector<DirectionKind> kinds = {plane_normal, plane_normal, vanishing_direction, potential_direction};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(update.landmarks[i].kind, kinds[i]);
    EXPECT_EQ(update.landmarks[i].observations, 1);
    EXPECT_EQ(update.landmarks[i].first_seen, KeyframeId{0});
  }
  EXPECT_TRUE(update.landmarks[1].direction.isApprox(kWall.in_world, 1e-12)) << "in the world frame";
  EXPECT_EQ(builder.graph().version(), 1);
}

TEST(GraphBuilder, ParallelWallsOfOneViewAreOneLandmark) {
  GraphBuilder builder;
  const Seen opposite{plane_normal, -kWall.in_world};
  const GraphUpdate update = add(builder, keyframe(0, {kWall, opposite, kWall, kFloor}));
  ASSERT_EQ(update.landmarks.size(), 2U);
  EXPECT_EQ(update.observations.size(), 4U);
  EXPECT_EQ(update.landmarks[0].observations, 1) << "counts keyframes";
  for (const Observation& observation : update.observations) {
    if (observation.landmark == update.landmarks[0].id) {
      EXPECT_TRUE(observation.direction_in_camera.isApprox(kWall.in_world, 1e-9)) << "signs are unified";
    }
  }
}

TEST(GraphBuilder, FusionConvergesToTheTruth) {
  base::Random random(2);
  GraphBuilderOptions fusion_alone;
  fusion_alone.optimizer.refine = Refinement::none;
  GraphBuilder builder(fusion_alone);
  for (int id = 0; id < 60; ++id) {
    // Every keyframe's rotation is wrong by as much as it says, every direction too, and the sign of lines is a coin's.
    geometry::Pose pose = test::random_pose(random);
    std::vector<Seen> seen = {kFloor, kWall, kEdges};
    if (random.index(2) == 0) seen[2].in_world *= -1.0;
    Keyframe frame = keyframe(id, pose, seen, &random, id == 0 ? 0.0005 : 0.004);
    if (id > 0)
      frame.world_from_camera.rotation = geometry::so3_exp(test::normal_vector(random, 0.004)) * pose.rotation;
    add(builder, frame);
  }
  ASSERT_EQ(builder.graph().landmarks().size(), 3U);
  const Vector3d truths[] = {kFloor.in_world, kWall.in_world, kEdges.in_world};
  for (int i = 0; i < 3; ++i) {
    const DirectionLandmark& landmark = *builder.graph().find_landmark(LandmarkId{i});
    EXPECT_EQ(landmark.observations, 60);
    EXPECT_LT(geometry::axial_angle(landmark.direction, truths[i]), 0.2 * kDegree);
    EXPECT_NEAR(landmark.direction.norm(), 1.0, 1e-12);
    EXPECT_NEAR((landmark.covariance * landmark.direction).norm(), 0.0, 1e-9) << "tangential";
    EXPECT_LT(largest_sigma(landmark.covariance), 0.15 * kDegree);
    EXPECT_GT(largest_sigma(landmark.covariance), 0.04 * kDegree) << "walls are not parallel to better than that";
  }
}

TEST(GraphBuilder, APotentialDirectionThatFindsAPartnerIsAVanishingDirection) {
  const Vector3d ramp = Vector3d(1, 0.5, 0).normalized();
  const Vector3d beam = Vector3d(0, 0.5, 1).normalized();
  GraphBuilder builder;
  add(builder, keyframe(0, {kFloor, {potential_direction, ramp}, {potential_direction, beam}}));
  add(builder, keyframe(1, {kFloor, {vanishing_direction, -ramp}}));
  const auto kind = [&](int id) { return builder.graph().find_landmark(LandmarkId{id})->kind; };
  EXPECT_EQ(kind(1), vanishing_direction) << "PD and VD";
  EXPECT_EQ(kind(2), potential_direction);
  add(builder, keyframe(2, {kFloor, {potential_direction, beam}}));
  EXPECT_EQ(kind(2), vanishing_direction) << "PD and PD";
  EXPECT_EQ(builder.graph().landmarks().size(), 3U) << "fused, not doubled";
  EXPECT_EQ(builder.graph().find_landmark(LandmarkId{1})->observations, 2);
}

TEST(GraphBuilder, TwoParallelSingleLinesOfOneViewAreAVanishingDirection) {
  const Vector3d ramp = Vector3d(1, 0.5, 0).normalized();
  GraphBuilder builder;
  const GraphUpdate update = add(builder, keyframe(0, {{potential_direction, ramp}, {potential_direction, -ramp}}));
  ASSERT_EQ(update.landmarks.size(), 1U);
  EXPECT_EQ(update.landmarks[0].kind, vanishing_direction);
}

TEST(GraphBuilder, APotentialDirectionJoinsAVanishingDirection) {
  GraphBuilder builder;
  add(builder, keyframe(0, {kFloor, kEdges}));
  add(builder, keyframe(1, {kFloor, {potential_direction, kEdges.in_world}}));
  EXPECT_EQ(builder.graph().landmarks().size(), 2U);
  EXPECT_EQ(builder.graph().find_landmark(LandmarkId{1})->kind, vanishing_direction);
  EXPECT_EQ(builder.graph().edges_to_older(builder.graph().keyframes().back().id).size(), 1U)
      << "it takes part in edges";
}

TEST(GraphBuilder, PlanesAndLinesWithOneDirectionStayApart) {
  GraphBuilder builder;
  add(builder, keyframe(0, {kFloor, {vanishing_direction, kFloor.in_world}}));
  EXPECT_EQ(builder.graph().landmarks().size(), 2U);
}

TEST(GraphBuilder, ASinglePotentialDirectionIsRemovedAfterItsLifetime) {
  GraphBuilderOptions options;
  options.potential_lifetime = 4;
  GraphBuilder builder(options);
  add(builder, keyframe(0, {kFloor, kEdges, {potential_direction, Vector3d(1, 0.5, 0).normalized()}}));
  for (int id = 1; id < 4; ++id) EXPECT_TRUE(add(builder, keyframe(id, {kFloor, kEdges})).removed.empty());
  const GraphUpdate last = add(builder, keyframe(4, {kFloor, kEdges}));
  EXPECT_EQ(last.removed, std::vector{LandmarkId{2}});
  EXPECT_EQ(builder.graph().find_landmark(LandmarkId{2}), nullptr);
  EXPECT_EQ(builder.graph().landmarks().size(), 2U) << "planes and vanishing directions stay";
  for (int id = 5; id < 20; ++id) EXPECT_TRUE(add(builder, keyframe(id, {})).removed.empty());
  // Its number is not used again.
  const GraphUpdate later = add(builder, keyframe(20, {{potential_direction, Vector3d(0, 1, 1).normalized()}}));
  EXPECT_EQ(later.landmarks.front().id, LandmarkId{3});
}

TEST(GraphBuilder, APotentialDirectionSeenAtTheLastMomentStays) {
  GraphBuilderOptions options;
  options.potential_lifetime = 4;
  GraphBuilder builder(options);
  const Seen ramp{potential_direction, Vector3d(1, 0.5, 0).normalized()};
  add(builder, keyframe(0, {kFloor, ramp}));
  for (int id = 1; id < 4; ++id) add(builder, keyframe(id, {kFloor}));
  const GraphUpdate last = add(builder, keyframe(4, {kFloor, ramp}));
  EXPECT_TRUE(last.removed.empty());
  EXPECT_EQ(builder.graph().find_landmark(LandmarkId{1})->kind, vanishing_direction);
}

TEST(GraphBuilder, EdgesJoinKeyframesThatShareTwoDirectionsThatAreNotParallel) {
  GraphBuilder builder;
  const Seen slope{plane_normal, Vector3d(std::sin(7 * kDegree), std::cos(7 * kDegree), 0)};
  add(builder, keyframe(0, {kFloor, kWall}));
  EXPECT_TRUE(edges_after(builder, keyframe(1, {kFloor})).empty()) << "one landmark";
  EXPECT_TRUE(edges_after(builder, keyframe(2, {kFloor, slope})).empty()) << "one shared landmark";
  EXPECT_TRUE(edges_after(builder, keyframe(3, {kFloor, slope})).empty()) << "two shared, but nearly parallel";
  const std::vector<Edge> edges = edges_after(builder, keyframe(4, {kFloor, kWall, slope}));
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_EQ(edges[0].first, KeyframeId{0});
  EXPECT_EQ(edges[0].second, KeyframeId{4});
  EXPECT_EQ(edges[0].shared, (std::vector{LandmarkId{0}, LandmarkId{1}}));
}

TEST(GraphBuilder, EdgesJoinViewsThatDoNotOverlap) {
  // Two cameras look at opposite walls of a room: no common point, but common normals.
  GraphBuilder builder;
  const geometry::Pose looking_forth{};
  const geometry::Pose looking_back{geometry::so3_exp({0, 180 * kDegree, 0}), {0, 0, -3}};
  add(builder, keyframe(0, looking_forth, {{plane_normal, -Vector3d::UnitZ()}, {plane_normal, -Vector3d::UnitY()}}));
  const GraphUpdate update =
      add(builder, keyframe(1, looking_back, {{plane_normal, Vector3d::UnitZ()}, {plane_normal, -Vector3d::UnitY()}}));
  EXPECT_EQ(builder.graph().edges_to_older(KeyframeId{1}).size(), 1U);
  EXPECT_TRUE(update.covisible.empty());
}

TEST(GraphBuilder, ARepeatedKeyframeGetsItsFirstAnswerAgain) {
  base::Random random(4);
  GraphBuilder builder;
  std::vector<GraphUpdate> answers;
  std::vector<Keyframe> keyframes;
  for (int id = 0; id < 5; ++id) {
    keyframes.push_back(keyframe(id, test::random_pose(random), {kFloor, kWall, kEdges}, &random));
    answers.push_back(add(builder, keyframes.back()));
  }
  const std::int64_t version = builder.graph().version();
  for (std::size_t id = 0; id < 5; ++id) EXPECT_TRUE(same(add(builder, keyframes[id]), answers[id]));
  EXPECT_EQ(builder.graph().version(), version);
  EXPECT_EQ(builder.graph().keyframes().size(), 5U);
}

TEST(GraphBuilder, RefusesAKeyframeThatComesTooEarly) {
  GraphBuilder builder;
  add(builder, keyframe(0, {kFloor}));
  const auto refused = builder.add_keyframe(keyframe(2, {kFloor}));
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().message.find("keyframe 2"), std::string::npos);
  EXPECT_NE(refused.error().message.find("keyframe 1"), std::string::npos);
  EXPECT_EQ(builder.graph().version(), 1);
}

TEST(GraphBuilder, UpdatesRebuildTheGraphElsewhere) {
  base::Random random(5);
  GraphBuilder builder;
  Graph replica;
  for (int id = 0; id < 30; ++id) {
    std::vector<Seen> seen = {kFloor, kEdges};
    if (id % 3 == 0) seen.push_back(kWall);
    if (id % 4 == 0) seen.push_back({potential_direction, test::random_direction(random)});
    ASSERT_TRUE(replica.apply(add(builder, keyframe(id, test::random_pose(random), seen, &random))));
  }
  const GraphSnapshot here = builder.graph().snapshot(3);
  const GraphSnapshot there = replica.snapshot(3);
  ASSERT_EQ(here.landmarks.size(), there.landmarks.size());
  for (std::size_t i = 0; i < here.landmarks.size(); ++i) {
    EXPECT_EQ(here.landmarks[i].direction, there.landmarks[i].direction);
    EXPECT_EQ(here.landmarks[i].kind, there.landmarks[i].kind);
  }
  EXPECT_EQ(here.observations.size(), there.observations.size());
}

TEST(GraphBuilder, AKeyframeWithoutDirectionsIsANode) {
  GraphBuilder builder;
  const GraphUpdate update = add(builder, keyframe(0, {}));
  EXPECT_TRUE(update.landmarks.empty());
  EXPECT_EQ(builder.graph().keyframes().size(), 1U);
}

}  // namespace
}  // namespace eg::egraph
