#include "common/tracking/map_correction.hpp"

#include "tests/support/random_geometry.hpp"
#include "tests/unit/tracking/hand_made_frames.hpp"
#include "tests/unit/tracking/tracker_loop.hpp"

namespace eg::tracking {
namespace {

/// Around the room, with the local map as the tracker left it.
Map walked_map() {
  const geometry::CameraModel camera = *geometry::find_camera("tum_fr3");
  SlamLoop slam;
  for (const FrameFeatures& frame :
       test::record(test::make_room(oblique_room()), camera, walk_around(camera, 80), 1).frames) {
    slam.step(frame);
  }
  return slam.tracker().map();
}

TEST(MapCorrection, AllKeyframesTogetherTakeTheMapAlong) {
  const Map before = walked_map();
  Map after = before;
  base::Random random(1);
  const Pose motion = test::random_pose(random);
  std::vector<egraph::CorrectedPose> corrected;
  for (const MapKeyframe& keyframe : before.keyframes()) {
    corrected.push_back({keyframe.id, motion * keyframe.world_from_camera});
  }
  move_with_keyframes(corrected, after);
  ASSERT_GT(after.points().size(), 100U);
  for (const MapPoint& point : before.points()) {
    EXPECT_LT((after.point(point.id).position - motion * point.position).norm(), 1e-9);
  }
  for (const MapLine& line : before.lines()) {
    EXPECT_LT((after.line(line.id).start - motion * line.start).norm(), 1e-9);
    EXPECT_LT((after.line(line.id).end - motion * line.end).norm(), 1e-9);
  }
  for (const MapPlane& plane : before.planes()) {
    const geometry::Plane expected = geometry::transform(motion, plane.estimate.plane);
    EXPECT_LT((after.plane(plane.id).estimate.plane.normal - expected.normal).norm(), 1e-9);
    EXPECT_NEAR(after.plane(plane.id).estimate.plane.distance, expected.distance, 1e-9);
  }
  for (const MapKeyframe& keyframe : before.keyframes()) {
    EXPECT_EQ(after.keyframe(keyframe.id).world_from_camera.translation,
              (motion * keyframe.world_from_camera).translation);
  }
}

TEST(MapCorrection, AFeatureGoesToTheMeanOfWhereItsKeyframesTakeIt) {
  const FrameFeatures frame = frame_of({point_at({320, 240}, with_bits(0)), point_at({100, 100}, with_bits(64))});
  Map map = map_of(frame);
  map.add_keyframe(frame_of({point_at({320, 240}, with_bits(0))}), Pose{}, {{{0, PointId{0}}}, {}, {}});
  const Vector3d shared = map.point(PointId{0}).position;
  const Vector3d alone = map.point(PointId{1}).position;
  const Vector3d step(0.0, 0.02, 0.04);
  move_with_keyframes(std::vector<egraph::CorrectedPose>{{KeyframeId{1}, {Eigen::Matrix3d::Identity(), step}}}, map);
  EXPECT_LT((map.point(PointId{0}).position - (shared + 0.5 * step)).norm(), 1e-12);
  EXPECT_EQ(map.point(PointId{1}).position, alone);
}

Map three_keyframes(const std::vector<Pose>& poses) {
  Map map;
  for (const Pose& pose : poses) map.add_keyframe(frame_of({}), pose, {});
  return map;
}

TEST(MapCorrection, WhereNothingHappenedMeanwhileTheRefinedPoseIsTakenToTheLastBit) {
  base::Random random(2);
  const std::vector<Pose> poses = {test::random_pose(random), test::random_pose(random), test::random_pose(random)};
  const Pose refined = test::random_pose(random);
  const auto moved = corrected_poses(
      three_keyframes(poses), std::vector<KeyframeCorrection>{{KeyframeId{1}, poses[1], refined}}, KeyframeId{2});
  ASSERT_EQ(moved.size(), 1U) << "the newest keyframe that the refinement knew stays, and with it what is younger";
  EXPECT_EQ(moved[0].world_from_camera.rotation, refined.rotation);
  EXPECT_EQ(moved[0].world_from_camera.translation, refined.translation);
}

TEST(MapCorrection, StepsAddUpAndYoungerKeyframesGoAlong) {
  base::Random random(3);
  const std::vector<Pose> poses = {test::random_pose(random), test::random_pose(random), test::random_pose(random)};
  const Pose adjusted = test::random_pose(random);  // by local bundle adjustment, since it was announced
  const Pose refined = test::random_pose(random);
  const auto moved =
      corrected_poses(three_keyframes({poses[0], adjusted, poses[2]}),
                      std::vector<KeyframeCorrection>{{KeyframeId{1}, poses[1], refined}}, KeyframeId{1});
  ASSERT_EQ(moved.size(), 2U);
  const Pose motion = refined * poses[1].inverse();
  EXPECT_LT((moved[0].world_from_camera.translation - (motion * adjusted).translation).norm(), 1e-9);
  EXPECT_EQ(moved[1].keyframe, KeyframeId{2});
  EXPECT_LT((moved[1].world_from_camera.translation - (motion * poses[2]).translation).norm(), 1e-9);
}

TEST(MapCorrection, TheTrackerFollowsARefinedGraph) {
  const geometry::CameraModel camera = *geometry::find_camera("icl");
  const FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera, walk_around(camera, 240), 1);
  for (const egraph::Refinement refine : {egraph::Refinement::rotations, egraph::Refinement::poses}) {
    egraph::GraphBuilderOptions options;
    options.optimizer.refine = refine;
    SlamLoop slam({}, options);
    for (const FrameFeatures& frame : sequence.frames) ASSERT_TRUE(slam.step(frame).has_pose);
    EXPECT_GT(slam.corrections(), 0);
    // Both know the same poses, to the last bit.
    for (const egraph::KeyframeNode& node : slam.graph().keyframes()) {
      const Pose& of_tracker = slam.tracker().map().keyframe(node.id).world_from_camera;
      EXPECT_EQ(of_tracker.rotation, node.world_from_camera.rotation);
      EXPECT_EQ(of_tracker.translation, node.world_from_camera.translation);
    }
    const test::LoopErrors errors = test::errors(slam.estimates(), sequence);
    EXPECT_LT(errors.mean_rotation, 0.25 * kDegree);
    EXPECT_LT(errors.mean_translation, 0.015);
  }
}

}  // namespace
}  // namespace eg::tracking
