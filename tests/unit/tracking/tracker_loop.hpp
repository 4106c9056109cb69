#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/random_geometry.hpp"
#include "tests/support/slam_loop.hpp"

/// Rooms and paths for the tests of the whole tracker.
namespace eg::tracking {

using Eigen::Vector3d;
using features::FrameFeatures;
using geometry::Pose;
using test::FeatureSequence;
using test::kDegree;
using test::SlamLoop;

/// A room that is not aligned with anything.
inline test::RoomOptions oblique_room() {
  test::RoomOptions options;
  options.orientation = geometry::so3_exp({0.0, 0.3, 0.0});
  return options;
}

inline test::RoomOptions white_room() {
  test::RoomOptions options = oblique_room();
  options.corners_per_wall = 0;
  options.lines = false;
  return options;
}

/// Walks around the room's middle once, looking outwards.
inline std::vector<Pose> walk_around(const geometry::CameraModel& camera, int frames) {
  std::vector<Pose> poses;
  for (int i = 0; i < frames; ++i) {
    const double a = 2.0 * M_PI * i / frames;
    const Vector3d position(0.6 * std::sin(a), 0.15 * std::sin(3 * a), -0.6 * std::cos(a));
    const Vector3d target(2.0 * std::sin(a + 0.6), 0.3 * std::cos(2 * a), -2.0 * std::cos(a + 0.6));
    poses.push_back(test::looking_at(position, target, camera));
  }
  return poses;
}

/// Turns once about the camera's own centre.
inline std::vector<Pose> turn_around(const geometry::CameraModel& camera, int frames) {
  std::vector<Pose> poses;
  for (int i = 0; i < frames; ++i) {
    const double a = 2.0 * M_PI * i / frames;
    poses.push_back(test::looking_at({0.2, 0, 0.1}, Vector3d(0.2 + std::sin(a), 0.1, 0.1 + std::cos(a)), camera));
  }
  return poses;
}

/// Moves a little in front of a corner of the oblique room, all three walls in view.
inline std::vector<Pose> before_a_corner(const geometry::CameraModel& camera, int frames) {
  const Eigen::Matrix3d room = oblique_room().orientation;
  std::vector<Pose> poses;
  for (int i = 0; i < frames; ++i) {
    const double a = 0.05 * i;
    const Vector3d position(0.5 + 0.2 * std::sin(a), -0.3 + 0.1 * std::sin(0.7 * a), 0.4 * (1.0 - std::cos(0.8 * a)));
    poses.push_back(test::looking_at(room * position, room * Vector3d(2.5, 1.0, 2.5), camera));
  }
  return poses;
}

class TrackerLoop : public testing::TestWithParam<const char*> {
 protected:
  static SlamLoop run(const FeatureSequence& sequence) {
    SlamLoop slam;
    for (const FrameFeatures& frame : sequence.frames) EXPECT_TRUE(test::is_sound(slam.step(frame)));
    return slam;
  }

  static int count(const SlamLoop& slam, TrackingState state) {
    return static_cast<int>(std::count_if(slam.estimates().begin(), slam.estimates().end(),
                                          [state](const PoseEstimate& e) { return e.state == state; }));
  }

  geometry::CameraModel camera_ = *geometry::find_camera(GetParam());
};

/// For INSTANTIATE_TEST_SUITE_P: an ordinary camera, and one of negative fy.
inline auto two_cameras() { return testing::Values("tum_fr3", "icl"); }
inline std::string camera_name(const testing::TestParamInfo<const char*>& camera) { return camera.param; }

}  // namespace eg::tracking
