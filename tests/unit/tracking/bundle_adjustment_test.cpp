// Local bundle adjustment on worlds known at the level of features.
#include "common/tracking/bundle_adjustment.hpp"

#include "common/tracking/bundle_residuals.hpp"

#include "tests/unit/tracking/tracker_loop.hpp"

namespace eg::tracking {
namespace {

using BundleAdjustment = TrackerLoop;

TrackerOptions without_adjustment() {
  TrackerOptions options;
  options.parts.local_bundle_adjustment = false;
  return options;
}

/// A tracked walk whose measurements are exact, without local bundle adjustment.
SlamLoop exact_walk(const geometry::CameraModel& camera) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera, walk_around(camera, 240), 1,
                                                test::SensorNoise{.disturb = false});
  SlamLoop slam(without_adjustment());
  for (std::size_t i = 0; i < 120; ++i) slam.step(sequence.frames[i]);
  return slam;
}

double worst_angle(const Map& a, const Map& b) {
  double worst = 0.0;
  for (const MapKeyframe& keyframe : a.keyframes()) {
    worst = std::max(worst, geometry::rotation_angle_between(keyframe.world_from_camera.rotation,
                                                             b.keyframe(keyframe.id).world_from_camera.rotation));
  }
  return worst;
}

double worst_shift(const Map& a, const Map& b) {
  double worst = 0.0;
  for (const MapKeyframe& keyframe : a.keyframes()) {
    worst = std::max(
        worst, (keyframe.world_from_camera.translation - b.keyframe(keyframe.id).world_from_camera.translation).norm());
  }
  return worst;
}

TEST_P(BundleAdjustment, PutsADisturbedWindowBack) {
  const SlamLoop slam = exact_walk(camera_);
  const Map& truth = slam.tracker().map();
  const LocalWindow window = local_window(truth, truth.keyframes().back().id, 5);
  ASSERT_GE(window.keyframes.size(), 4u) << "five, but for the first one of the map";
  ASSERT_GT(window.points.size(), 50u);
  ASSERT_GT(window.lines.size(), 2u);
  ASSERT_GT(window.planes.size(), 1u);

  base::Random random(2);
  Map map = truth;
  for (const KeyframeId id : window.keyframes) {
    Vector6d step;
    step << test::normal_vector(random, 0.003), test::normal_vector(random, 0.01);
    map.move_keyframe(id, perturb(truth.keyframe(id).world_from_camera.inverse(), step).inverse());
  }
  for (const PointId id : window.points)
    map.move_point(id, truth.point(id).position + test::normal_vector(random, 0.005));
  for (const PlaneId id : window.planes) {
    map.move_plane(id, move_plane(truth.plane(id).estimate.plane, test::normal_vector(random, 0.003)));
  }
  ASSERT_GT(worst_shift(map, truth), 0.01);

  BundleOptions options;
  options.iterations = 20;
  const BundleSolution solution = adjust_bundle(map, slam.graph(), window, options);
  EXPECT_LT(solution.final_cost, 0.01 * solution.initial_cost);
  apply(solution, map);
  EXPECT_LT(worst_angle(map, truth), 0.02 * test::kDegree);
  EXPECT_LT(worst_shift(map, truth), 0.001);
  for (const PointId id : window.points) {
    EXPECT_LT((map.point(id).position - truth.point(id).position).norm(), 0.01) << "point " << id.value;
  }
  for (const PlaneId id : window.planes) {
    const Vector3d difference = plane_difference(truth.plane(id).estimate.plane, map.plane(id).estimate.plane);
    EXPECT_LT(difference.norm(), 0.002) << "plane " << id.value;
  }
}

TEST_P(BundleAdjustment, LeavesAnExactMapAlone) {
  const SlamLoop slam = exact_walk(camera_);
  Map map = slam.tracker().map();
  apply(adjust_bundle(map, slam.graph(), local_window(map, map.keyframes().back().id, 8)), map);
  EXPECT_LT(worst_angle(map, slam.tracker().map()), 0.01 * test::kDegree);
  EXPECT_LT(worst_shift(map, slam.tracker().map()), 5e-4);
}

TEST_P(BundleAdjustment, DepthOfTheSurfaceBehindAnEdgePullsNothing) {
  FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 1,
                                          test::SensorNoise{.disturb = false});
  base::Random random(3);
  for (FrameFeatures& frame : sequence.frames) {
    for (features::PointFeature& point : frame.points) {
      if (random.uniform(0.0, 1.0) < 0.1) point.depth *= random.uniform(1.1, 2.0);
    }
    for (features::LineFeature& line : frame.lines) {
      if (random.uniform(0.0, 1.0) > 0.1) continue;
      const double farther = random.uniform(1.1, 2.0);
      line.start *= farther;
      line.end *= farther;
    }
  }
  SlamLoop slam;
  for (std::size_t i = 0; i < 120; ++i) slam.step(sequence.frames[i]);
  const test::LoopErrors errors = test::errors(slam.estimates(), sequence);
  EXPECT_EQ(errors.poses, 120);
  EXPECT_LT(errors.worst_translation, 0.01);
  EXPECT_LT(errors.worst_rotation, 0.2 * test::kDegree);
}

TEST_P(BundleAdjustment, GivesTheSameBytesEveryTime) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 4);
  SlamLoop slam(without_adjustment());
  for (std::size_t i = 0; i < 100; ++i) slam.step(sequence.frames[i]);
  const Map& map = slam.tracker().map();
  const LocalWindow window = local_window(map, map.keyframes().back().id, 6);
  const BundleSolution first = adjust_bundle(map, slam.graph(), window);
  const std::vector<double> elsewhere(100'000);  // moves what the allocator does next
  const Map copy = map;
  const BundleSolution second = adjust_bundle(copy, slam.graph(), window);
  ASSERT_EQ(first.world_from_camera.size(), second.world_from_camera.size());
  for (std::size_t i = 0; i < first.world_from_camera.size(); ++i) {
    EXPECT_EQ(first.world_from_camera[i].second.rotation, second.world_from_camera[i].second.rotation);
    EXPECT_EQ(first.world_from_camera[i].second.translation, second.world_from_camera[i].second.translation);
  }
  for (std::size_t i = 0; i < first.points.size(); ++i) EXPECT_EQ(first.points[i].second, second.points[i].second);
}

TEST_P(BundleAdjustment, TheTrackerReportsWhatItMoved) {
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera_, walk_around(camera_, 240), 5);
  Tracker tracker;
  egraph::GraphBuilder builder;
  std::map<KeyframeId, Pose> announced;
  for (std::size_t i = 0; i < 80; ++i) {
    const TrackResult result = tracker.track(sequence.frames[i]);
    for (const auto& [id, pose] : result.corrections) announced[id] = pose;
    if (result.keyframe) {
      announced[result.keyframe->id] = result.keyframe->world_from_camera;
      const auto refined = tracker.follow(*builder.add_keyframe(*result.keyframe));
      ASSERT_TRUE(refined.has_value());
      for (const egraph::CorrectedPose& moved : *refined) announced[moved.keyframe] = moved.world_from_camera;
    }
  }
  ASSERT_GT(announced.size(), 3u);
  for (const MapKeyframe& keyframe : tracker.map().keyframes()) {
    EXPECT_EQ(announced.at(keyframe.id).translation, keyframe.world_from_camera.translation) << keyframe.id.value;
    EXPECT_EQ(announced.at(keyframe.id).rotation, keyframe.world_from_camera.rotation) << keyframe.id.value;
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, BundleAdjustment, two_cameras(), camera_name);

class LocalWindowOfAWalk : public testing::Test {
 protected:
  SlamLoop slam_ = exact_walk(*geometry::find_camera("tum_fr3"));
  const Map& map_ = slam_.tracker().map();
};

TEST_F(LocalWindowOfAWalk, HoldsTheNewestKeyframeAndNeverTheFirst) {
  const KeyframeId newest = map_.keyframes().back().id;
  const LocalWindow window = local_window(map_, newest, 4);
  EXPECT_EQ(window.keyframes.size(), 4u);
  EXPECT_TRUE(window.contains(newest));
  EXPECT_TRUE(std::is_sorted(window.keyframes.begin(), window.keyframes.end()));
  const LocalWindow all = local_window(map_, newest, 1000);
  EXPECT_FALSE(all.contains(KeyframeId{0}));
  EXPECT_TRUE(local_window(map_, KeyframeId{0}, 1).keyframes.empty()) << "the world stays where it is";
}

TEST_F(LocalWindowOfAWalk, HoldsWhatSeveralKeyframesSaw) {
  const LocalWindow window = local_window(map_, map_.keyframes().back().id, 4);
  for (const PointId id : window.points) {
    EXPECT_GE(map_.observers(id).size(), 2u);
    EXPECT_TRUE(std::any_of(map_.observers(id).begin(), map_.observers(id).end(),
                            [&](const Observer& observer) { return window.contains(observer.keyframe); }));
  }
  EXPECT_TRUE(std::adjacent_find(window.points.begin(), window.points.end()) == window.points.end()) << "each once";
}

TEST_F(LocalWindowOfAWalk, WhatOnlyOneKeyframeSawMovesWithIt) {
  Map map = map_;
  const MapKeyframe& newest = map.keyframes().back();
  const auto alone = std::find_if(newest.matches.points.begin(), newest.matches.points.end(),
                                  [&](const PointMatch& match) { return map.observers(match.id).size() == 1; });
  ASSERT_NE(alone, newest.matches.points.end());
  const Vector3d in_camera = newest.world_from_camera.inverse() * map.point(alone->id).position;
  BundleSolution solution;
  Pose moved = newest.world_from_camera;
  moved.translation += Vector3d(0.1, 0.2, 0.3);
  solution.world_from_camera.emplace_back(newest.id, moved);
  apply(solution, map);
  EXPECT_LT((map.keyframe(newest.id).world_from_camera.inverse() * map.point(alone->id).position - in_camera).norm(),
            1e-12);
}

}  // namespace
}  // namespace eg::tracking
