#include <gtest/gtest.h>

#include "common/tracking/matcher.hpp"
#include "tests/support/random_geometry.hpp"
#include "tests/unit/tracking/hand_made_frames.hpp"

namespace eg::tracking {
namespace {

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

}  // namespace
}  // namespace eg::tracking
