#include "common/tracking/map.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/feature_world.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::tracking {
namespace {

using Eigen::Vector3d;
using features::FrameFeatures;
using features::LineFeature;
using features::PlaneFeature;
using features::PointFeature;
using geometry::Pose;

const geometry::CameraModel kCamera = *geometry::find_camera("tum_fr3");

PointFeature point_at(const Vector3d& in_camera, double sigma = 0.01) {
  PointFeature point;
  point.pixel = kCamera.project(in_camera);
  point.pixel_sigma = sigma * kCamera.fx / in_camera.z();
  point.depth = in_camera.z();
  point.depth_sigma = sigma;
  return point;
}

LineFeature line_between(const Vector3d& a, const Vector3d& b, double sigma = 0.01) {
  LineFeature line;
  line.start_pixel = kCamera.project(a);
  line.end_pixel = kCamera.project(b);
  line.has_depth = true;
  line.start = a;
  line.end = b;
  line.start_covariance = line.end_covariance = sigma * sigma * Eigen::Matrix3d::Identity();
  return line;
}

PlaneFeature plane_at(double distance) {
  PlaneFeature plane;
  plane.centroid = {0, 0, distance};
  plane.plane = {{0, 0, -1}, distance};
  plane.covariance.diagonal() << 1e-5, 1e-5, 0, 1e-4;
  return plane;
}

FrameFeatures frame_of(std::vector<PointFeature> points, std::vector<LineFeature> lines = {},
                       std::vector<PlaneFeature> planes = {}) {
  FrameFeatures frame;
  frame.camera = kCamera;
  frame.points = std::move(points);
  frame.lines = std::move(lines);
  frame.planes = std::move(planes);
  return frame;
}

TEST(Map, AKeyframeBringsItsFeaturesThatHaveDepth) {
  base::Random random(1);
  const Pose pose = test::random_pose(random);
  PointFeature without_depth = point_at({0, 0, 2});
  without_depth.depth = 0.0;
  LineFeature flat = line_between({0, 0, 2}, {1, 0, 2});
  flat.has_depth = false;
  Map map;
  EXPECT_TRUE(map.empty());
  const KeyframeId id = map.add_keyframe(
      frame_of({point_at({0.1, 0.2, 2}), without_depth}, {flat, line_between({0, 0, 2}, {1, 0, 2})}, {plane_at(2)}),
      pose, {});
  EXPECT_EQ(id, KeyframeId{0});
  EXPECT_FALSE(map.empty());
  ASSERT_EQ(map.points().size(), 1U);
  ASSERT_EQ(map.lines().size(), 1U);
  ASSERT_EQ(map.planes().size(), 1U);
  EXPECT_LT((map.points()[0].position - pose * Vector3d(0.1, 0.2, 2)).norm(), 1e-9);
  EXPECT_LT((map.lines()[0].end - pose * Vector3d(1, 0, 2)).norm(), 1e-9);
  EXPECT_NEAR(map.planes()[0].estimate.plane.signed_distance(pose * Vector3d(0.5, -0.3, 2)), 0.0, 1e-9);
  EXPECT_EQ(map.keyframe(id).matches.points.size(), 1U) << "the keyframe observes what it made";
  EXPECT_EQ(map.keyframe(id).matches.lines[0].feature, 1);
}

TEST(Map, PointCovarianceIsThatOfPixelAndDepth) {
  base::Random random(2);
  const Pose pose = test::random_pose(random);
  PointFeature feature = point_at({0.6, -0.4, 2.5});
  feature.pixel_sigma = 3.0;
  feature.depth_sigma = 0.03;
  Map map;
  map.add_keyframe(frame_of({feature}), pose, {});
  Eigen::Matrix3d sampled = Eigen::Matrix3d::Zero();
  constexpr int kSamples = 20'000;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector2d pixel = feature.pixel + 3.0 * Eigen::Vector2d(random.normal(), random.normal());
    const Vector3d place = pose * kCamera.unproject(pixel, feature.depth + 0.03 * random.normal());
    const Vector3d error = place - map.points()[0].position;
    sampled += error * error.transpose() / kSamples;
  }
  EXPECT_LT((sampled - map.points()[0].covariance).norm(), 0.05 * sampled.norm());
}

TEST(Map, FusionConvergesToTheTruth) {
  base::Random random(3);
  const Vector3d point(0.2, -0.1, 2.0);
  const Vector3d start(-0.5, 0.3, 2.0);
  const Vector3d end(0.5, 0.3, 2.2);
  Map map;
  for (int view = 0; view < 60; ++view) {
    const Pose pose{geometry::so3_exp(test::normal_vector(random, 0.05)), test::normal_vector(random, 0.1)};
    const auto noisy = [&](const Vector3d& in_world) -> Vector3d {
      return pose.inverse() * in_world + test::normal_vector(random, 0.01);
    };
    // The line's ends slide along it from view to view.
    const Vector3d slide = random.uniform(-0.2, 0.2) * (end - start);
    PlaneFeature plane;
    plane.plane = geometry::transform(pose.inverse(), {{0, 0, -1}, 2.0 + 0.01 * random.normal()});
    plane.covariance.bottomRightCorner<1, 1>().setConstant(1e-4);
    const auto frame =
        frame_of({point_at(noisy(point))}, {line_between(noisy(start + slide), noisy(end + slide))}, {plane});
    Matches matches;
    if (view > 0) matches = {{{0, PointId{0}}}, {{0, LineId{0}}}, {{0, PlaneId{0}}}};
    map.add_keyframe(frame, pose, matches);
  }
  ASSERT_EQ(map.points().size(), 1U);
  ASSERT_EQ(map.lines().size(), 1U);
  ASSERT_EQ(map.planes().size(), 1U);
  EXPECT_EQ(map.points()[0].observations, 60);
  EXPECT_LT((map.points()[0].position - point).norm(), 0.006);
  EXPECT_LT(map.points()[0].covariance.trace(), 3 * 0.004 * 0.004);
  const Vector3d along = (end - start).normalized();
  for (const Vector3d& at : {map.lines()[0].start, map.lines()[0].end}) {
    EXPECT_LT((at - start).cross(along).norm(), 0.006) << "across the line";
  }
  EXPECT_NEAR(map.planes()[0].estimate.plane.distance, 2.0, 0.006);
}

TEST(Map, MovesNothingByAMatchWithoutDepth) {
  PointFeature without_depth = point_at({0.3, 0, 2});
  without_depth.depth = 0.0;
  Map map;
  map.add_keyframe(frame_of({point_at({0, 0, 2})}), Pose{}, {});
  map.add_keyframe(frame_of({without_depth}), Pose{}, {{{0, PointId{0}}}, {}, {}});
  EXPECT_EQ(map.points().size(), 1U);
  EXPECT_LT((map.points()[0].position - Vector3d(0, 0, 2)).norm(), 1e-9);
  EXPECT_EQ(map.points()[0].observations, 2);
}

TEST(Map, CullsWhatIsExpectedOftenAndFoundRarely) {
  Map map;
  map.add_keyframe(frame_of({point_at({0, 0, 2}), point_at({0.5, 0, 2})}, {line_between({0, 0, 2}, {1, 0, 2})}), Pose{},
                   {});
  const std::vector<PointId> points = {PointId{0}, PointId{1}};
  const std::vector<LineId> lines = {LineId{0}};
  for (int frame = 0; frame < 19; ++frame) map.count_visibility(points, lines, {{{0, PointId{1}}}, {}, {}});
  EXPECT_TRUE(map.point(PointId{0}).alive) << "too early to tell";
  map.count_visibility(points, lines, {{{0, PointId{1}}}, {}, {}});
  EXPECT_FALSE(map.point(PointId{0}).alive);
  EXPECT_TRUE(map.point(PointId{1}).alive);
  EXPECT_FALSE(map.line(LineId{0}).alive);
  EXPECT_EQ(map.points_near(kCamera, Pose{}), std::vector{PointId{1}});
  EXPECT_TRUE(map.lines_near(kCamera, Pose{}).empty());
  EXPECT_EQ(map.points().size(), 2U) << "its number keeps its meaning";
}

TEST(Map, KeepsALineThatASecondKeyframeConfirmed) {
  const FrameFeatures frame = frame_of({}, {line_between({0, 0, 2}, {1, 0, 2})});
  Map map;
  map.add_keyframe(frame, Pose{}, {});
  map.add_keyframe(frame, Pose{}, {{}, {{0, LineId{0}}}, {}});
  for (int expected = 0; expected < 100; ++expected) map.count_visibility({}, std::vector{LineId{0}}, {});
  EXPECT_EQ(map.lines_near(kCamera, Pose{}).size(), 1U);
}

TEST(Map, KeepsWhatIsFoundOftenEnough) {
  Map map;
  map.add_keyframe(frame_of({point_at({0, 0, 2})}), Pose{}, {});
  for (int frame = 0; frame < 200; ++frame) {
    Matches found;
    if (frame % 3 == 0) found.points.push_back({0, PointId{0}});
    map.count_visibility(std::vector{PointId{0}}, {}, found);
  }
  EXPECT_TRUE(map.point(PointId{0}).alive);
}

TEST(Map, NearQueriesMissNothingThatIsInTheImage) {
  // Against looking at every point of a map of three rooms in a row.
  base::Random random(4);
  Map map;
  for (int room_number = 0; room_number < 3; ++room_number) {
    const Vector3d centre(6.0 * room_number, 0, 0);
    for (int view = 0; view < 8; ++view) {
      const test::FeatureWorld room = test::make_room({.corners_per_wall = 60, .seed = 7});
      const Pose in_room{geometry::so3_exp({0, 0.8 * view, 0}), Vector3d::Zero()};
      map.add_keyframe(test::observe(room, kCamera, in_room, {}, random), Pose{in_room.rotation, centre}, {});
    }
  }
  ASSERT_GT(map.points().size(), 700U);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose camera_from_world = Pose{test::random_rotation(random), {random.uniform(-3, 15), 0, 0}}.inverse();
    const auto near = map.points_near(kCamera, camera_from_world);
    EXPECT_TRUE(std::is_sorted(near.begin(), near.end()));
    EXPECT_LT(near.size(), map.points().size());
    for (const MapPoint& point : map.points()) {
      const Vector3d in_camera = camera_from_world * point.position;
      if (in_camera.z() < 0.2 || in_camera.norm() > 8.0 || !kCamera.contains(kCamera.project(in_camera))) continue;
      EXPECT_TRUE(std::binary_search(near.begin(), near.end(), point.id));
    }
    const auto near_lines = map.lines_near(kCamera, camera_from_world);
    for (const MapLine& line : map.lines()) {
      const Vector3d middle = camera_from_world * (0.5 * (line.start + line.end));
      if (middle.z() < 0.2 || middle.norm() > 8.0 || !kCamera.contains(kCamera.project(middle))) continue;
      EXPECT_TRUE(std::binary_search(near_lines.begin(), near_lines.end(), line.id));
    }
  }
}

TEST(Map, CovisibleKeyframesMostSharedFirst) {
  std::vector<PointFeature> three = {point_at({0, 0, 2}), point_at({0.3, 0, 2}), point_at({0.6, 0, 2})};
  Map map;
  map.add_keyframe(frame_of(three), Pose{}, {});
  map.add_keyframe(frame_of({three[0]}, {}, {plane_at(2)}), Pose{}, {{{0, PointId{0}}}, {}, {}});
  map.add_keyframe(frame_of({point_at({-1, 0, 2})}), Pose{}, {});
  const KeyframeId last =
      map.add_keyframe(frame_of(three, {}, {plane_at(2)}), Pose{},
                       {{{0, PointId{0}}, {1, PointId{1}}, {2, PointId{2}}}, {}, {{0, PlaneId{0}}}});
  const auto covisible = map.covisible(last);
  ASSERT_EQ(covisible.size(), 2U);
  EXPECT_EQ(covisible[0].keyframe, KeyframeId{0});
  EXPECT_EQ(covisible[0].shared_features, 3);
  EXPECT_EQ(covisible[1].keyframe, KeyframeId{1});
  EXPECT_EQ(covisible[1].shared_features, 2) << "a point and a plane";
  EXPECT_TRUE(map.covisible(KeyframeId{2}).empty());
}

TEST(Map, OptimisersMoveWhatIsThere) {
  Map map;
  map.add_keyframe(frame_of({point_at({0, 0, 2})}, {line_between({0, 0, 2}, {1, 0, 2})}, {plane_at(2)}), Pose{}, {});
  const Pose moved{Eigen::Matrix3d::Identity(), {1, 2, 3}};
  map.move_keyframe(KeyframeId{0}, moved);
  map.move_point(PointId{0}, {5, 5, 5});
  map.move_line(LineId{0}, {1, 1, 1}, {2, 2, 2});
  map.move_plane(PlaneId{0}, {{1, 0, 0}, 4});
  EXPECT_EQ(map.keyframe(KeyframeId{0}).world_from_camera.translation, moved.translation);
  EXPECT_EQ(map.point(PointId{0}).position, Vector3d(5, 5, 5));
  EXPECT_EQ(map.line(LineId{0}).end, Vector3d(2, 2, 2));
  EXPECT_EQ(map.plane(PlaneId{0}).estimate.plane.distance, 4.0);
}

}  // namespace
}  // namespace eg::tracking
