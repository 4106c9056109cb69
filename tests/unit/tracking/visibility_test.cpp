#include "common/tracking/visibility.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/random_geometry.hpp"
#include "tests/unit/tracking/hand_made_frames.hpp"
#include "tests/unit/tracking/tracker_loop.hpp"

namespace eg::tracking {
namespace {

LineFeature line_between(const Vector3d& start, const Vector3d& end) {
  LineFeature line;
  line.has_depth = true;
  line.start = start;
  line.end = end;
  line.start_pixel = kCamera.project(start);
  line.end_pixel = kCamera.project(end);
  line.start_covariance = line.end_covariance = 1e-6 * Eigen::Matrix3d::Identity();
  return line;
}

std::size_t visible(const Map& map, const Pose& world_from_camera) {
  return visible_lines(kCamera, map, all_lines(map), world_from_camera.inverse()).size();
}

TEST(VisibleLines, AreThoseOfWhichALongPieceIsInTheImage) {
  FrameFeatures frame;
  frame.camera = kCamera;
  frame.lines = {line_between({-0.5, 0, 2}, {0.5, 0, 2})};
  const Map map = map_of(frame);
  const auto turned = [](double degrees) {
    return Pose{geometry::so3_exp({0, degrees * test::kDegree, 0}), Vector3d::Zero()};
  };
  EXPECT_EQ(visible(map, Pose{}), 1U);
  EXPECT_EQ(visible(map, turned(30)), 1U) << "half of it";
  EXPECT_EQ(visible(map, turned(42)), 0U) << "a short piece at the border";
  EXPECT_EQ(visible(map, turned(90)), 0U);
  EXPECT_EQ(visible(map, turned(180)), 0U) << "behind the camera";
  EXPECT_EQ(visible(map, {Eigen::Matrix3d::Identity(), {0, 0, -8}}), 0U) << "too far away for a detector";
  // From behind, as through the wall that it is drawn on.
  EXPECT_EQ(visible(map, {geometry::so3_exp({0, M_PI, 0}), {0, 0, 4}}), 0U);
}

TEST(VisibleLines, ReachingBehindTheCamera) {
  FrameFeatures frame;
  frame.camera = kCamera;
  frame.lines = {line_between({1, 0.5, 1}, {1, 0.5, 6})};
  const Map map = map_of(frame);
  EXPECT_EQ(visible(map, {Eigen::Matrix3d::Identity(), {0, 0, 2}}), 1U);
  EXPECT_EQ(visible(map, {Eigen::Matrix3d::Identity(), {0, 0, 8}}), 0U);
}

using Culling = TrackerLoop;

/// Reflections and shadows: lines that are there in one frame only. Those of old keyframes are culled, true ones stay.
TEST_P(Culling, OfFalseLines) {
  const FeatureSequence sequence =
      test::record(test::make_room(oblique_room()), camera_, before_a_corner(camera_, 200), 51);
  base::Random random(52);
  SlamLoop slam;
  for (FrameFeatures frame : sequence.frames) {
    for (int i = 0; i < 5; ++i) {
      const Vector2d start(random.uniform(50, 300), random.uniform(50, 400));
      LineFeature line;
      line.start_pixel = start;
      line.end_pixel = start + Vector2d(random.uniform(100, 250), random.uniform(-100, 100));
      line.has_depth = true;
      line.start = camera_.unproject(line.start_pixel, 2.0);
      line.end = camera_.unproject(line.end_pixel, 2.0);
      line.start_covariance = line.end_covariance = 1e-5 * Eigen::Matrix3d::Identity();
      for (std::uint8_t& byte : line.descriptor) byte = static_cast<std::uint8_t>(random.index(256));
      frame.lines.push_back(line);
    }
    EXPECT_EQ(slam.step(frame).state, TrackingState::tracking);
  }
  const Map& map = slam.tracker().map();
  ASSERT_GE(map.keyframes().size(), 10U);
  ASSERT_GE(map.lines().size(), 50U) << "every keyframe brought five";
  const Pose camera_from_world = slam.estimates().back().world_from_camera.inverse();
  const auto living = map.lines_near(camera_, camera_from_world).size();
  EXPECT_LE(living, 25U) << "the true ones, and those of the last keyframes";
  const auto confirmed = std::count_if(map.lines().begin(), map.lines().end(),
                                       [](const MapLine& line) { return line.observations >= 3 && line.alive; });
  EXPECT_GE(confirmed, 3) << "the true ones";
}

/// Somebody stands before half of the wall for 85 frames. What has a name is not taken for gone.
TEST_P(Culling, SparesWhatHasANameAndIsHidden) {
  for (const bool named : {true, false}) {
    test::SensorNoise noise;
    noise.identities = named;
    const FeatureSequence sequence =
        test::record(test::make_room(oblique_room()), camera_, before_a_corner(camera_, 100), 53, noise);
    SlamLoop slam;
    for (FrameFeatures frame : sequence.frames) {
      if (frame.header.sequence >= 5 && frame.header.sequence < 90) {
        std::erase_if(frame.points, [&](const PointFeature& point) { return point.pixel.x() < camera_.width / 2.0; });
      }
      EXPECT_EQ(slam.step(frame).state, TrackingState::tracking);
    }
    std::set<std::int32_t> names;  // only the oldest of a name counts: others are of views that disagreed
    const auto points = slam.tracker().map().points();
    const auto culled = std::count_if(points.begin(), points.end(), [&](const MapPoint& point) {
      const bool is_oldest = !named || names.insert(point.track_id).second;
      return is_oldest && !point.alive;
    });
    EXPECT_EQ(culled > 0, !named) << culled << " of " << points.size() << " points";
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, Culling, two_cameras(), camera_name);

}  // namespace
}  // namespace eg::tracking
