#include "common/tracking/matcher.hpp"

#include <gtest/gtest.h>

#include "common/tracking/visibility.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/random_geometry.hpp"
#include "tests/unit/tracking/hand_made_frames.hpp"

namespace eg::tracking {
namespace {

std::vector<PointMatch> matched(const Map& map, const std::vector<PointFeature>& seen,
                                const MatchOptions& options = {}) {
  return match_points(frame_of(seen), map, all_points(map), Pose{}, options);
}

TEST(HammingDistance, CountsBits) {
  EXPECT_EQ(hamming_distance({}, {}), 0);
  EXPECT_EQ(hamming_distance(with_bits(256), {}), 256);
  EXPECT_EQ(hamming_distance(with_bits(10), with_bits(10, 5)), 10);
}

TEST(MatchPoints, OfAWholeRoom) {
  // Most corners are found again by another view, and hardly one wrongly.
  base::Random random(1);
  for (const char* name : {"tum_fr3", "icl"}) {
    const geometry::CameraModel camera = *geometry::find_camera(name);
    const test::FeatureWorld room = test::make_room({.corners_per_wall = 400});
    const Pose first = test::looking_at({0, 0, -1}, {0.3, 0.1, 2}, camera);
    const Pose second = test::looking_at({0.1, 0.05, -0.9}, {0.4, 0.0, 2}, camera);
    Map map;
    map.add_keyframe(test::observe(room, camera, first, {}, random), first, {});
    const FrameFeatures frame = test::observe(room, camera, second, {}, random);
    const auto matches = match_points(frame, map, all_points(map), second.inverse());
    EXPECT_GT(matches.size(), frame.points.size() * 6 / 10) << name;
    for (const PointMatch& match : matches) {
      const PointFeature& seen = frame.points[static_cast<std::size_t>(match.feature)];
      const Vector3d place = second * camera.unproject(seen.pixel, seen.depth);
      EXPECT_LT((place - map.point(match.id).position).norm(), 0.15) << name;
    }
  }
}

TEST(MatchPoints, SearchesAroundTheExpectedPixelOnly) {
  const Map map = map_of(frame_of({point_at({300, 200}, with_bits(40))}));
  EXPECT_EQ(matched(map, {point_at({314, 200}, with_bits(40))}).size(), 1U);
  EXPECT_EQ(matched(map, {point_at({316, 200}, with_bits(40))}).size(), 0U);
  EXPECT_EQ(matched(map, {point_at({316, 200}, with_bits(40))}, {.radius = 20}).size(), 1U);
}

TEST(MatchPoints, AtTheEdgeOfTheImage) {
  const std::vector<PointFeature> corners = {point_at({0, 0}, with_bits(40)), point_at({639, 0}, with_bits(40)),
                                             point_at({0, 479}, with_bits(40)), point_at({639, 479}, with_bits(40))};
  EXPECT_EQ(matched(map_of(frame_of(corners)), corners).size(), 4U);
}

TEST(MatchPoints, DescriptorsMustBeAlikeAndDistinct) {
  const Map map = map_of(frame_of({point_at({300, 200}, {})}));
  EXPECT_EQ(matched(map, {point_at({300, 200}, with_bits(64))}).size(), 1U);
  EXPECT_EQ(matched(map, {point_at({300, 200}, with_bits(65))}).size(), 0U);
  // Best against second best: at most 0.85 of it.
  EXPECT_EQ(matched(map, {point_at({300, 200}, with_bits(34)), point_at({302, 200}, with_bits(40))}).size(), 1U);
  EXPECT_EQ(matched(map, {point_at({300, 200}, with_bits(35)), point_at({302, 200}, with_bits(40))}).size(), 0U);
}

TEST(MatchPoints, IsOneToOne) {
  const Map map = map_of(frame_of({point_at({300, 200}, with_bits(10)), point_at({304, 200}, {})}));
  const auto matches = matched(map, {point_at({302, 200}, {})});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].id, PointId{1}) << "the more alike one";
}

TEST(MatchPoints, TheOctaveMustFitTheDistance) {
  const Map map = map_of(frame_of({point_at({319, 247}, with_bits(40), 2.0, 2)}));
  const auto seen_from = [&](double z, int octave) {
    const Pose camera_from_world{Eigen::Matrix3d::Identity(), {0, 0, -z}};
    const auto frame = frame_of({point_at({319, 247}, with_bits(40), 2.0 - z, octave)});
    return match_points(frame, map, all_points(map), camera_from_world).size();
  };
  EXPECT_EQ(seen_from(0.0, 2), 1U);
  EXPECT_EQ(seen_from(0.0, 3), 1U);
  EXPECT_EQ(seen_from(0.0, 4), 0U);
  EXPECT_EQ(seen_from(0.0, 0), 0U);
  // Seen from half the distance it is twice as large: 3.8 octaves up.
  EXPECT_EQ(seen_from(1.0, 6), 1U);
  EXPECT_EQ(seen_from(1.0, 2), 0U);
}

TEST(MatchPoints, SeenFromAsideACornerIsNotExpected) {
  const Map map = map_of(frame_of({point_at({320, 247}, with_bits(40))}));
  const Vector3d point = map.points()[0].position;
  const auto seen_from = [&](double degrees) {
    const Eigen::Matrix3d turn = geometry::so3_exp({0, degrees * test::kDegree, 0});
    const Pose world_from_camera{turn, point - 2.0 * turn.col(2)};
    const auto frame = frame_of({point_at(kCamera.project(world_from_camera.inverse() * point), with_bits(40))});
    return match_points(frame, map, all_points(map), world_from_camera.inverse()).size();
  };
  EXPECT_EQ(seen_from(0), 1U);
  EXPECT_EQ(seen_from(55), 1U);
  EXPECT_EQ(seen_from(65), 0U);
  EXPECT_EQ(seen_from(180), 0U);
}

TEST(MatchPoints, AKnownTrackIdDecides) {
  PointFeature known = point_at({300, 200}, with_bits(40));
  known.track_id = 7;
  const Map map = map_of(frame_of({known}));
  PointFeature decoy = point_at({300, 200}, with_bits(40));
  decoy.track_id = 8;
  PointFeature same = point_at({20, 400}, with_bits(256));
  same.track_id = 7;
  const auto matches = matched(map, {decoy, same});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].feature, 1);
  EXPECT_TRUE(matched(map, {decoy}).empty());
}

TEST(MatchPoints, OfTwoWithTheSameTrackIdTakesTheOlder) {
  PointFeature point = point_at({20, 400}, with_bits(40));
  point.track_id = 7;
  const Map map = map_of(frame_of({point, point}));
  const auto matches = matched(map, {point});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].id, PointId{0});
}

TEST(MatchPoints, OfNothing) {
  const Map map = map_of(frame_of({point_at({300, 200}, with_bits(40))}));
  EXPECT_TRUE(matched(map, {}).empty());
  EXPECT_TRUE(match_points(frame_of({point_at({300, 200}, with_bits(40))}), Map{}, {}, Pose{}).empty());
}

TEST(VisiblePoints, AreThoseInTheImage) {
  const Map map = map_of(frame_of({point_at({10, 200}, {}), point_at({600, 200}, {})}));
  const Pose turned_right{geometry::so3_exp({0, -20 * test::kDegree, 0}), Vector3d::Zero()};
  EXPECT_EQ(visible_points(kCamera, map, all_points(map), Pose{}).size(), 2U);
  EXPECT_EQ(visible_points(kCamera, map, all_points(map), turned_right), std::vector{PointId{1}});
}

TEST(MatchByDescriptor, FindsPointsWhereverTheyAreInTheImage) {
  const Map map = map_of(frame_of({point_at({300, 200}, with_bits(60)), point_at({100, 100}, with_bits(60, 100))}));
  const auto frame = frame_of({point_at({20, 20}, with_bits(60, 102)), point_at({600, 400}, with_bits(60, 2)),
                               point_at({300, 200}, with_bits(100, 150))});
  const auto matches = match_points_by_descriptor(frame, map, map.keyframes()[0]);
  ASSERT_EQ(matches.size(), 2U);
  EXPECT_EQ(matches[0].id, PointId{1});
  EXPECT_EQ(matches[1].id, PointId{0});
}

}  // namespace
}  // namespace eg::tracking
