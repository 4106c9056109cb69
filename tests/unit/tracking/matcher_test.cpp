#include "common/tracking/matcher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/support/feature_world.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::tracking {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using features::Descriptor;
using features::FrameFeatures;
using features::LineFeature;
using features::PlaneFeature;
using features::PointFeature;
using geometry::Pose;

const geometry::CameraModel kCamera = *geometry::find_camera("tum_fr3");

/// A descriptor that differs in `bits` bits from zero, starting at bit `from`.
Descriptor with_bits(int bits, int from = 0) {
  Descriptor descriptor{};
  for (int bit = from; bit < from + bits; ++bit) {
    auto& byte = descriptor[static_cast<std::size_t>(bit / 8)];
    byte = static_cast<std::uint8_t>(byte | (1 << (bit % 8)));
  }
  return descriptor;
}

PointFeature point_at(const Vector2d& pixel, const Descriptor& descriptor, double depth = 2.0, int octave = 0) {
  PointFeature point;
  point.pixel = pixel;
  point.depth = depth;
  point.depth_sigma = 0.01;
  point.octave = octave;
  point.descriptor = descriptor;
  return point;
}

FrameFeatures frame_of(const std::vector<PointFeature>& points) {
  FrameFeatures frame;
  frame.camera = kCamera;
  frame.points = points;
  return frame;
}

Map map_of(const FrameFeatures& frame) {
  Map map;
  map.add_keyframe(frame, Pose{}, {});
  return map;
}

std::vector<PointId> all_points(const Map& map) {
  std::vector<PointId> ids;
  for (const MapPoint& point : map.points()) ids.push_back(point.id);
  return ids;
}

std::vector<LineId> all_lines(const Map& map) {
  std::vector<LineId> ids;
  for (const MapLine& line : map.lines()) ids.push_back(line.id);
  return ids;
}

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

LineFeature line_between(const Vector2d& a, const Vector2d& b, const Descriptor& descriptor = {}) {
  LineFeature line;
  line.start_pixel = a;
  line.end_pixel = b;
  line.has_depth = true;
  line.start = kCamera.unproject(a, 2.0);
  line.end = kCamera.unproject(b, 2.0);
  line.start_covariance = line.end_covariance = 1e-4 * Eigen::Matrix3d::Identity();
  line.descriptor = descriptor;
  return line;
}

FrameFeatures frame_of_lines(const std::vector<LineFeature>& lines) {
  FrameFeatures frame;
  frame.camera = kCamera;
  frame.lines = lines;
  return frame;
}

std::vector<LineMatch> matched_lines(const Map& map, const std::vector<LineFeature>& seen) {
  return match_lines(frame_of_lines(seen), map, all_lines(map), Pose{});
}

TEST(MatchLines, AlongThePredictedSegment) {
  const Map map = map_of(frame_of_lines({line_between({100, 100}, {300, 100})}));
  const auto found = [&](const Vector2d& a, const Vector2d& b) {
    return matched_lines(map, {line_between(a, b)}).size();
  };
  EXPECT_EQ(found({100, 100}, {300, 100}), 1U);
  EXPECT_EQ(found({300, 100}, {100, 100}), 1U) << "the other way round";
  EXPECT_EQ(found({100, 112}, {300, 112}), 1U) << "aside";
  EXPECT_EQ(found({100, 120}, {300, 120}), 0U) << "too far aside";
  EXPECT_EQ(found({100, 90}, {300, 105}), 1U) << "a little turned";
  EXPECT_EQ(found({100, 80}, {300, 120}), 0U) << "turned too far: 11 degrees";
  EXPECT_EQ(found({210, 100}, {400, 100}), 0U) << "less than half overlaps";
  EXPECT_EQ(found({190, 100}, {390, 100}), 1U) << "more than half overlaps";
  EXPECT_EQ(found({250, 100}, {290, 100}), 1U) << "a piece of it";
  EXPECT_EQ(found({310, 100}, {400, 100}), 0U) << "in the same line, but elsewhere";
}

TEST(MatchLines, TakesTheMoreAlikeOfTwo) {
  const Map map = map_of(frame_of_lines({line_between({100, 100}, {300, 100}, with_bits(60))}));
  const auto matches = matched_lines(map, {line_between({100, 101}, {300, 101}, with_bits(60, 30)),
                                           line_between({100, 105}, {300, 105}, with_bits(60))});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].feature, 1);
  EXPECT_TRUE(matched_lines(map, {line_between({100, 100}, {300, 100}, with_bits(100, 150))}).empty());
}

TEST(MatchLines, IsOneToOneAndKnowsTrackIds) {
  const Map two = map_of(frame_of_lines({line_between({100, 100}, {300, 100}), line_between({100, 104}, {300, 104})}));
  const auto one = matched_lines(two, {line_between({100, 103}, {300, 103})});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].id, LineId{1});

  LineFeature known = line_between({100, 100}, {300, 100});
  known.track_id = 5;
  const Map map = map_of(frame_of_lines({known}));
  LineFeature same = line_between({10, 400}, {20, 300});
  same.track_id = 5;
  const auto matches = matched_lines(map, {line_between({100, 100}, {300, 100}), same});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].feature, 1);
}

TEST(MatchLines, ReachingBehindTheCamera) {
  // A long edge along the camera's way: its far part is seen ahead.
  LineFeature edge = line_between({0, 0}, {0, 0});
  edge.start = {1, 0.5, -2};
  edge.end = {1, 0.5, 6};
  const Map map = map_of(frame_of_lines({edge}));
  const auto seen = line_between(kCamera.project({1, 0.5, 2}), kCamera.project({1, 0.5, 5}));
  EXPECT_EQ(matched_lines(map, {seen}).size(), 1U);
  const Pose beyond{Eigen::Matrix3d::Identity(), {0, 0, -7}};
  EXPECT_TRUE(match_lines(frame_of_lines({seen}), map, all_lines(map), beyond).empty());
}

PlaneFeature plane_at(double distance, double tilt_degrees = 0.0) {
  PlaneFeature plane;
  plane.centroid = {0, 0, distance};
  plane.plane.normal = geometry::so3_exp({0, tilt_degrees * test::kDegree, 0}) * Vector3d(0, 0, -1);
  plane.plane.distance = -plane.plane.normal.dot(plane.centroid);
  plane.support = 10'000;
  return plane;
}

std::size_t matched_planes(const Map& map, const PlaneFeature& seen, double position_sigma) {
  FrameFeatures frame = frame_of({});
  frame.planes = {seen};
  return match_planes(frame, map, Pose{}, position_sigma).size();
}

TEST(MatchPlanes, WithinTheGates) {
  FrameFeatures frame = frame_of({});
  frame.planes = {plane_at(2.0)};
  const Map map = map_of(frame);
  EXPECT_EQ(matched_planes(map, plane_at(2.05), 0.05), 1U);
  EXPECT_EQ(matched_planes(map, plane_at(2.09), 0.05), 1U);
  EXPECT_EQ(matched_planes(map, plane_at(2.11), 1.00), 0U) << "never beyond 10 cm";
  EXPECT_EQ(matched_planes(map, plane_at(2.05), 0.01), 0U) << "five standard deviations";
  EXPECT_EQ(matched_planes(map, plane_at(2.0, 9.0), 0.05), 1U);
  EXPECT_EQ(matched_planes(map, plane_at(2.0, 11.0), 0.05), 0U);
  PlaneFeature back = plane_at(2.0);
  back.plane.normal *= -1.0;
  back.plane.distance *= -1.0;
  EXPECT_EQ(matched_planes(map, back, 0.05), 0U) << "the other side of a wall is another plane";
}

TEST(MatchPlanes, SeveralRegionsMayLieOnOnePlaneAndEachTakesTheBest) {
  FrameFeatures frame = frame_of({});
  frame.planes = {plane_at(2.0), plane_at(2.06)};
  const Map map = map_of(frame);
  FrameFeatures seen = frame_of({});
  seen.planes = {plane_at(2.05), plane_at(2.055), plane_at(2.01)};
  const auto matches = match_planes(seen, map, Pose{}, 0.05);
  ASSERT_EQ(matches.size(), 3U);
  EXPECT_EQ(matches[0].id, PlaneId{1});
  EXPECT_EQ(matches[1].id, PlaneId{1});
  EXPECT_EQ(matches[2].id, PlaneId{0});
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
