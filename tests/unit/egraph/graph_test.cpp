#include "common/egraph/graph.hpp"

#include <gtest/gtest.h>

#include "tests/support/random_geometry.hpp"

namespace eg::egraph {
namespace {

using Eigen::Vector3d;

DirectionLandmark landmark(int id, const Vector3d& direction) {
  DirectionLandmark result;
  result.id = LandmarkId{id};
  result.direction = direction.normalized();
  return result;
}

/// The update of keyframe `id`, which sees the given landmarks.
GraphUpdate update(int id, const std::vector<DirectionLandmark>& landmarks) {
  GraphUpdate result;
  result.session = 5;
  result.base_version = id;
  result.version = id + 1;
  result.keyframe.id = KeyframeId{id};
  result.keyframe.utime = 1'000 * id;
  result.landmarks = landmarks;
  for (const DirectionLandmark& seen : landmarks) {
    result.observations.push_back({KeyframeId{id}, seen.id, seen.direction, Eigen::Matrix3d::Zero()});
  }
  return result;
}

const DirectionLandmark kX = landmark(0, Vector3d::UnitX());
const DirectionLandmark kY = landmark(1, Vector3d::UnitY());
const DirectionLandmark kZ = landmark(2, Vector3d::UnitZ());
const DirectionLandmark kNearX = landmark(3, Vector3d(1, std::tan(8.0 * test::kDegree), 0));

std::vector<KeyframeId> olders(const std::vector<Edge>& edges) {
  std::vector<KeyframeId> keyframes;
  for (const Edge& edge : edges) keyframes.push_back(edge.first);
  return keyframes;
}

TEST(Graph, StartsEmpty) {
  const Graph graph;
  EXPECT_EQ(graph.version(), 0);
  EXPECT_TRUE(graph.landmarks().empty());
  EXPECT_EQ(graph.find_landmark(LandmarkId{0}), nullptr);
  EXPECT_EQ(graph.find_keyframe(KeyframeId{0}), nullptr);
  EXPECT_TRUE(graph.observers(LandmarkId{0}).empty());
  EXPECT_TRUE(graph.sharing_keyframes({}).empty());
  EXPECT_FALSE(graph.oldest_sharing_keyframe({}).has_value());
}

TEST(Graph, AnUpdateLeadsToTheNextVersion) {
  Graph graph;
  ASSERT_TRUE(graph.apply(update(0, {kX, kY})));
  ASSERT_TRUE(graph.apply(update(1, {kY, kZ})));
  EXPECT_EQ(graph.version(), 2);
  EXPECT_EQ(graph.keyframes().size(), 2U);
  EXPECT_EQ(graph.find_keyframe(KeyframeId{1})->utime, 1'000);
  EXPECT_EQ(graph.landmarks().size(), 3U);
  EXPECT_EQ(graph.find_landmark(kZ.id)->direction, Vector3d::UnitZ());
  ASSERT_EQ(graph.observers(kY.id).size(), 2U);
  EXPECT_EQ(graph.observers(kY.id)[0], KeyframeId{0});
  EXPECT_EQ(graph.observers(kY.id)[1], KeyframeId{1});
}

TEST(Graph, RefusesAGapAndSaysWhere) {
  Graph graph;
  ASSERT_TRUE(graph.apply(update(0, {kX, kY})));
  const auto refused = graph.apply(update(2, {kZ}));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("version 2"), std::string::npos) << refused.error().message;
  EXPECT_NE(refused.error().message.find("at 1"), std::string::npos) << refused.error().message;
  EXPECT_EQ(graph.version(), 1);
  EXPECT_EQ(graph.find_landmark(kZ.id), nullptr) << "a refused update changes nothing";
}

TEST(Graph, IgnoresWhatItHasAlready) {
  Graph graph;
  ASSERT_TRUE(graph.apply(update(0, {kX, kY})));
  ASSERT_TRUE(graph.apply(update(1, {kX, kY})));
  ASSERT_TRUE(graph.apply(update(0, {kX, kY})));
  ASSERT_TRUE(graph.apply(update(1, {kX, kY})));
  EXPECT_EQ(graph.version(), 2);
  EXPECT_EQ(graph.keyframes().size(), 2U);
  EXPECT_EQ(graph.observers(kX.id).size(), 2U);
}

TEST(Graph, AChangedLandmarkReplacesTheOldOne) {
  Graph graph;
  ASSERT_TRUE(graph.apply(update(0, {kX, kY})));
  DirectionLandmark moved = kX;
  moved.direction = Vector3d(1, 0.01, 0).normalized();
  moved.observations = 2;
  ASSERT_TRUE(graph.apply(update(1, {moved})));
  EXPECT_EQ(graph.landmarks().size(), 2U);
  EXPECT_EQ(graph.find_landmark(kX.id)->direction, moved.direction);
  EXPECT_EQ(graph.find_landmark(kX.id)->observations, 2);
}

TEST(Graph, LandmarksStayOrderedById) {
  Graph graph;
  ASSERT_TRUE(graph.apply(update(0, {kZ, kX})));
  ASSERT_TRUE(graph.apply(update(1, {kY})));
  ASSERT_EQ(graph.landmarks().size(), 3U);
  for (int id = 0; id < 3; ++id) EXPECT_EQ(graph.landmarks()[static_cast<std::size_t>(id)].id, LandmarkId{id});
}

TEST(Graph, ARemovedLandmarkTakesItsObservationsAlong) {
  Graph graph;
  ASSERT_TRUE(graph.apply(update(0, {kX, kY, kZ})));
  GraphUpdate removal = update(1, {kX, kY});
  removal.removed = {kZ.id, LandmarkId{77}};
  ASSERT_TRUE(graph.apply(removal));
  EXPECT_EQ(graph.find_landmark(kZ.id), nullptr);
  EXPECT_TRUE(graph.observers(kZ.id).empty());
  for (const Observation& observation : graph.snapshot(5).observations) EXPECT_NE(observation.landmark, kZ.id);
}

TEST(Graph, SharingNeedsTwoLandmarksThatAreNotParallel) {
  Graph graph;
  ASSERT_TRUE(graph.apply(update(0, {kX, kNearX})));  // nearly parallel: no rotation about x
  ASSERT_TRUE(graph.apply(update(1, {kX})));
  ASSERT_TRUE(graph.apply(update(2, {kX, kY})));
  ASSERT_TRUE(graph.apply(update(3, {kX, kY, kZ, kNearX})));
  const std::vector<LandmarkId> all = {kX.id, kY.id, kZ.id, kNearX.id};
  const std::vector<Edge> sharing = graph.sharing_keyframes(all);
  ASSERT_EQ(olders(sharing), (std::vector<KeyframeId>{KeyframeId{2}, KeyframeId{3}}));
  EXPECT_EQ(sharing[0].shared, (std::vector<LandmarkId>{kX.id, kY.id}));
  EXPECT_EQ(sharing[1].shared, all);
  EXPECT_EQ(graph.oldest_sharing_keyframe(all), KeyframeId{2});
  EXPECT_FALSE(graph.oldest_sharing_keyframe(std::vector{kX.id, kNearX.id}).has_value());
  EXPECT_FALSE(graph.oldest_sharing_keyframe(std::vector{kX.id}).has_value());
  EXPECT_EQ(graph.oldest_sharing_keyframe(std::vector{kY.id, kZ.id}), KeyframeId{3});
}

TEST(Graph, OppositeDirectionsAreParallel) {
  Graph graph;
  const DirectionLandmark minus_x = landmark(1, -Vector3d::UnitX());
  ASSERT_TRUE(graph.apply(update(0, {kX, minus_x})));
  EXPECT_FALSE(graph.oldest_sharing_keyframe(std::vector{kX.id, minus_x.id}).has_value());
}

TEST(Graph, OneKeyframeThatSeesALandmarkTwiceIsOneObserver) {
  Graph graph;
  GraphUpdate twice = update(0, {kX, kY});
  twice.observations.push_back(twice.observations.front());
  ASSERT_TRUE(graph.apply(twice));
  EXPECT_EQ(graph.observers(kX.id).size(), 1U);
  const std::vector<Edge> sharing = graph.sharing_keyframes(std::vector{kX.id, kY.id});
  ASSERT_EQ(sharing.size(), 1U);
  EXPECT_EQ(sharing[0].shared.size(), 2U);
}

TEST(Graph, RelativePosesOfAKeyframeThatTheTrackerMovedAreMeasuredAgain) {
  Graph graph;
  base::Random random(1);
  for (int id = 0; id < 4; ++id) {
    GraphUpdate next = update(id, {});
    next.keyframe.world_from_camera = test::random_pose(random);
    if (id > 0) {
      next.relative_poses.push_back(
          {KeyframeId{id - 1}, KeyframeId{id}, test::random_pose(random), 0.1 * id * Matrix6d::Identity()});
    }
    ASSERT_TRUE(graph.apply(next));
  }
  const std::vector<RelativePose> before(graph.relative_poses_from(KeyframeId{0}).begin(),
                                         graph.relative_poses_from(KeyframeId{0}).end());
  GraphUpdate last = update(4, {});
  last.moved = {{KeyframeId{1}, test::random_pose(random)}};
  last.corrections = {{KeyframeId{2}, test::random_pose(random)}};  // no measurement
  const geometry::Pose second = graph.find_keyframe(KeyframeId{2})->world_from_camera;
  ASSERT_TRUE(graph.apply(last));
  const std::span<const RelativePose> after = graph.relative_poses_from(KeyframeId{0});
  ASSERT_EQ(after.size(), 3U);
  const auto expect_equal = [](const geometry::Pose& a, const geometry::Pose& b) {
    EXPECT_LT((a.rotation - b.rotation).norm(), 1e-12);
    EXPECT_LT((a.translation - b.translation).norm(), 1e-12);
  };
  const geometry::Pose& moved = last.moved[0].world_from_camera;
  expect_equal(after[0].first_from_second, graph.find_keyframe(KeyframeId{0})->world_from_camera.inverse() * moved);
  expect_equal(after[1].first_from_second, moved.inverse() * second);
  expect_equal(after[2].first_from_second, before[2].first_from_second);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(after[i].covariance, before[i].covariance);
}

TEST(Graph, ASnapshotIsTheWholeGraph) {
  Graph graph;
  ASSERT_TRUE(graph.apply(update(0, {kX, kY})));
  GraphUpdate second = update(1, {kX, kY, kZ});
  second.covisible = {{KeyframeId{0}, 42}};
  ASSERT_TRUE(graph.apply(second));
  const GraphSnapshot snapshot = graph.snapshot(5);
  EXPECT_EQ(snapshot.session, 5);
  EXPECT_EQ(snapshot.version, 2);
  EXPECT_EQ(snapshot.observations.size(), 5U);
  ASSERT_EQ(snapshot.covisibility.size(), 1U);
  EXPECT_EQ(snapshot.covisibility[0].first, KeyframeId{0});
  EXPECT_EQ(snapshot.covisibility[0].second, KeyframeId{1});
  EXPECT_EQ(snapshot.covisibility[0].shared_features, 42);

  Graph replica;
  ASSERT_TRUE(replica.apply(update(0, {kZ})));  // something else before: it is forgotten
  replica.reset(snapshot);
  EXPECT_EQ(replica.version(), 2);
  EXPECT_EQ(replica.keyframes().size(), 2U);
  EXPECT_EQ(replica.landmarks().size(), 3U);
  EXPECT_EQ(replica.edges_to_older(KeyframeId{1}).size(), 1U);
  EXPECT_EQ(replica.observers(kZ.id).size(), 1U);
  EXPECT_EQ(replica.oldest_sharing_keyframe(std::vector{kX.id, kY.id}), KeyframeId{0});

  // What comes after is the same for both.
  ASSERT_TRUE(graph.apply(update(2, {kY, kZ})));
  ASSERT_TRUE(replica.apply(update(2, {kY, kZ})));
  EXPECT_EQ(replica.oldest_sharing_keyframe(std::vector{kY.id, kZ.id}),
            graph.oldest_sharing_keyframe(std::vector{kY.id, kZ.id}));
}

}  // namespace
}  // namespace eg::egraph
