#include "common/tracking/relocaliser.hpp"

#include <gtest/gtest.h>

#include "tests/support/feature_world.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::tracking {
namespace {

using Eigen::Vector3d;
using geometry::Pose;
using test::kDegree;

TEST(AlignPoints, IsExactForThreePointsAndMore) {
  base::Random random(1);
  for (int trial = 0; trial < 1'000; ++trial) {
    const Pose truth = test::random_pose(random);
    std::vector<Vector3d> in_world;
    std::vector<Vector3d> in_camera;
    for (int i = 0; i < 3 + trial % 5; ++i) {
      in_world.push_back(test::normal_vector(random, 2.0));
      in_camera.push_back(truth * in_world.back());
    }
    const double area = (in_world[1] - in_world[0]).cross(in_world[2] - in_world[0]).norm();
    if (area < 0.1) continue;
    const Pose aligned = align_points(in_world, in_camera);
    ASSERT_LT(geometry::rotation_angle_between(aligned.rotation, truth.rotation), 1e-9);
    ASSERT_LT((aligned.translation - truth.translation).norm(), 1e-9);
  }
}

TEST(AlignPoints, NeverMirrors) {
  // Points whose best fit is a reflection.
  const std::vector<Vector3d> in_world = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, -1, -1}};
  std::vector<Vector3d> in_camera;
  for (const Vector3d& point : in_world) in_camera.push_back(Vector3d(point.x(), point.y(), -point.z()));
  EXPECT_NEAR(align_points(in_world, in_camera).rotation.determinant(), 1.0, 1e-9);
}

class Relocaliser : public testing::TestWithParam<const char*> {
 protected:
  Relocaliser() {
    const auto frame = test::observe(room_, camera_, keyframe_pose_, {}, random_);
    map_.add_keyframe(frame, keyframe_pose_, {});
  }

  features::FrameFeatures seen_from(const Pose& pose, const test::FeatureWorld& world) {
    return test::observe(world, camera_, pose, {}, random_);
  }

  base::Random random_{2};
  geometry::CameraModel camera_ = *geometry::find_camera(GetParam());
  test::FeatureWorld room_ = test::make_room();
  Pose keyframe_pose_ = test::looking_at({0, 0, -1}, {0.3, 0.1, 2}, camera_);
  Map map_;
};

TEST_P(Relocaliser, FindsTheCameraWithoutAPrediction) {
  for (int trial = 0; trial < 5; ++trial) {
    const Pose pose =
        test::looking_at(test::uniform_vector(random_, -0.5, 0.5) + Vector3d(0, 0, -0.8), {0.5, 0.0, 2}, camera_);
    const auto found = relocalise(seen_from(pose, room_), map_, map_.keyframes()[0]);
    ASSERT_TRUE(found.has_value());
    EXPECT_LT(geometry::rotation_angle_between(found->rotation, pose.rotation.transpose()), 2.0 * kDegree);
    EXPECT_LT((found->inverse().translation - pose.translation).norm(), 0.08);
  }
}

TEST_P(Relocaliser, FindsNothingInAnotherWorld) {
  const test::FeatureWorld other = test::make_room({.seed = 99});
  EXPECT_FALSE(relocalise(seen_from(keyframe_pose_, other), map_, map_.keyframes()[0]).has_value());
}

TEST_P(Relocaliser, FindsNothingInTheSameWorldLookingAway) {
  const Pose away = test::looking_at({0, 0, 1}, {0, 0, -2}, camera_);
  EXPECT_FALSE(relocalise(seen_from(away, room_), map_, map_.keyframes()[0]).has_value());
}

TEST_P(Relocaliser, FindsNothingInAnEmptyFrame) {
  features::FrameFeatures empty;
  empty.camera = camera_;
  EXPECT_FALSE(relocalise(empty, map_, map_.keyframes()[0]).has_value());
}

TEST_P(Relocaliser, IsRepeatable) {
  const auto frame = seen_from(keyframe_pose_, room_);
  const auto first = relocalise(frame, map_, map_.keyframes()[0]);
  const auto second = relocalise(frame, map_, map_.keyframes()[0]);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->rotation, second->rotation);
  EXPECT_EQ(first->translation, second->translation);
}

INSTANTIATE_TEST_SUITE_P(Cameras, Relocaliser, testing::Values("tum_fr3", "icl"),
                         [](const auto& camera) { return std::string(camera.param); });

}  // namespace
}  // namespace eg::tracking
