#include "common/observations/walk.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "common/observations/visible_part.hpp"

namespace eg::observations {
namespace {

const geometry::CameraModel kCamera = *geometry::find_camera("synthetic");
const WalkOptions kShort{.rooms = 3, .seconds_per_room = 20.0, .seed = 1};

TEST(Walk, EveryFrameSeesEnoughAndRoomsLeftBehindAreNeverSeenAgain) {
  const Recording walk = make_walk(kCamera, {}, kShort);
  ASSERT_EQ(walk.frames.size(), 60U * 30U);
  std::set<std::int32_t> seen_in_first_room;
  for (std::size_t i = 0; i < walk.frames.size(); ++i) {
    const RecordedFrame& frame = walk.frames[i];
    EXPECT_GE(frame.points.size(), 10U) << i;
    for (const PointObservation& point : frame.points) {
      EXPECT_TRUE(kCamera.contains(point.pixel));
      EXPECT_GT(point.true_depth, 0.0);
      // The first room that is walked through ends at x = 10 m.
      const Eigen::Vector3d place = frame.world_from_camera * kCamera.unproject(point.pixel, point.true_depth);
      if (i < 300 && place.x() < 9.5) seen_in_first_room.insert(point.id);
      // In the middle of the third room the first is two doors away.
      if (i > 1500) {
        EXPECT_FALSE(seen_in_first_room.contains(point.id)) << i;
      }
    }
  }
}

TEST(Walk, MeasurementsHaveTheStatedNoise) {
  const Recording noisy = make_walk(kCamera, {}, kShort);
  SensorModel exact_sensor;
  exact_sensor.pixel_sigma = exact_sensor.line_depth_sigma = 0.0;
  const Recording exact = make_walk(kCamera, exact_sensor, kShort);
  double squares = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < noisy.frames.size(); i += 30) {
    for (const PointObservation& point : noisy.frames[i].points) {
      const auto& all = exact.frames[i].points;
      const auto same = std::find_if(all.begin(), all.end(), [&](const auto& other) { return other.id == point.id; });
      if (same == all.end()) continue;  // the noise has moved it into the image
      squares += (point.pixel - same->pixel).squaredNorm();
      count += 2;
    }
  }
  ASSERT_GT(count, 1000);
  EXPECT_NEAR(squares / count, 1.0, 0.1);
}

TEST(VisiblePart, IsCutAtTheImageAndTheDepthLimits) {
  const auto part = visible_part({{-100, 0, 2}, {100, 0, 2}}, kCamera, 0.3, 8.0);
  ASSERT_TRUE(part.has_value());
  EXPECT_NEAR(kCamera.project(part->start).x(), 2.0, 1e-9);
  EXPECT_NEAR(kCamera.project(part->end).x(), kCamera.width - 3.0, 1e-9);
  const auto along = visible_part({{0, 0, -5}, {0, 0, 50}}, kCamera, 0.3, 8.0);
  ASSERT_TRUE(along.has_value());
  EXPECT_DOUBLE_EQ(along->start.z(), 0.3);
  EXPECT_DOUBLE_EQ(along->end.z(), 8.0);
  EXPECT_FALSE(visible_part({{-1, 0, -2}, {1, 0, -2}}, kCamera, 0.3, 8.0).has_value());
  EXPECT_FALSE(visible_part({{50, 0, 2}, {60, 0, 2}}, kCamera, 0.3, 8.0).has_value());
}

}  // namespace
}  // namespace eg::observations
