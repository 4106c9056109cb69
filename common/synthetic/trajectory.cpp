#include "common/synthetic/trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/so3.hpp"

namespace eg::synthetic {
namespace {

constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

/// A Lissajous figure around the room while the camera turns once to look at every wall.
Trajectory through_room() {
  return {.name = "room",
          .duration_s = 36.0,
          .x = {.offset = 0.15, .waves = {{1.25, 25.0, 0.1}, {0.08, 4.3, 0.3}}},
          .y = {.offset = 0.0, .waves = {{0.75, 18.0, 0.35}, {0.06, 3.7, 0.0}}},
          .z = {.offset = 1.4, .waves = {{0.12, 7.0, 0.2}, {0.02, 1.9, 0.5}}},
          .heading = {.offset = radians(75), .rate = radians(-10), .waves = {{radians(14), 6.1, 0.25}}},
          .tilt = {.offset = radians(12), .waves = {{radians(7), 8.3, 0.1}, {radians(1), 2.2, 0.0}}},
          .roll = {.waves = {{radians(3.5), 5.3, 0.4}}}};
}

Trajectory through_slanted() {
  return {.name = "slanted",
          .duration_s = 36.0,
          .x = {.offset = 0.1, .waves = {{0.7, 19.0, 0.0}, {0.06, 4.1, 0.2}}},
          .y = {.offset = 0.0, .waves = {{0.6, 14.0, 0.2}, {0.05, 3.3, 0.1}}},
          .z = {.offset = 1.35, .waves = {{0.1, 6.0, 0.0}}},
          .heading = {.offset = radians(20), .rate = radians(10), .waves = {{radians(12), 6.7, 0.6}}},
          .tilt = {.offset = radians(6), .waves = {{radians(9), 7.7, 0.3}}},
          .roll = {.waves = {{radians(4), 5.9, 0.1}}}};
}

/// Down the corridor and backwards again, looking left and right.
Trajectory through_corridor() {
  return {.name = "corridor",
          .duration_s = 30.0,
          .x = {.offset = -0.6, .waves = {{4.2, 60.0, 0.75}}},
          .y = {.waves = {{0.25, 9.0, 0.1}}},
          .z = {.offset = 1.45, .waves = {{0.06, 5.0, 0.0}}},
          .heading = {.offset = radians(4), .waves = {{radians(24), 11.0, 0.05}}},
          .tilt = {.offset = radians(9), .waves = {{radians(5), 7.3, 0.3}}},
          .roll = {.waves = {{radians(3), 6.1, 0.0}}}};
}

/// To and fro before the corner, always looking into it.
Trajectory before_corner() {
  return {.name = "corner",
          .duration_s = 20.0,
          .x = {.offset = -0.15, .waves = {{0.45, 9.0, 0.1}}},
          .y = {.offset = -0.1, .waves = {{0.4, 7.0, 0.3}}},
          .z = {.offset = 1.4, .waves = {{0.18, 5.0, 0.0}}},
          .heading = {.offset = radians(45), .waves = {{radians(9), 6.0, 0.2}}},
          .tilt = {.offset = radians(24), .waves = {{radians(6), 5.2, 0.4}}},
          .roll = {.waves = {{radians(5), 4.4, 0.1}}}};
}

/// On the spot: one turn in 18 s that speeds up and slows down a little.
Trajectory on_the_spot() {
  return {.name = "spin",
          .duration_s = 18.0,
          .x = {.offset = 0.1},
          .y = {.offset = -0.05},
          .z = {.offset = 1.35},
          .heading = {.offset = radians(30), .rate = radians(20), .waves = {{radians(8), 6.0, 0.0}}},
          .tilt = {.offset = radians(8), .waves = {{radians(6), 9.0, 0.2}}},
          .roll = {.waves = {{radians(3), 6.0, 0.3}}}};
}

std::vector<Trajectory> all_trajectories() {
  return {through_room(), through_slanted(), through_corridor(), before_corner(), on_the_spot()};
}

}  // namespace

double Channel::at(double t) const {
  double value = offset + rate * t;
  for (const Wave& wave : waves) {
    value += wave.amplitude * std::sin(2.0 * std::numbers::pi * (t / wave.period_s + wave.phase));
  }
  return value;
}

geometry::Pose Trajectory::world_from_camera(double t) const {
  Eigen::Matrix3d level;  // columns: right, down, forward of a camera that looks along the world's x axis
  level << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Matrix3d turn = geometry::so3_exp({0, 0, heading.at(t)});
  // A positive rotation about the camera's x axis lifts the view, so tilting down is a negative one.
  const Eigen::Matrix3d look = geometry::so3_exp({-tilt.at(t), 0, 0}) * geometry::so3_exp({0, 0, roll.at(t)});
  return {turn * level * look, {x.at(t), y.at(t), z.at(t)}};
}

std::vector<std::string> trajectory_names() {
  std::vector<std::string> names;
  for (const Trajectory& trajectory : all_trajectories()) names.push_back(trajectory.name);
  return names;
}

base::Result<Trajectory> make_trajectory(std::string_view name) {
  std::string known;
  for (Trajectory& trajectory : all_trajectories()) {
    if (trajectory.name == name) return trajectory;
    known += (known.empty() ? "" : ", ") + trajectory.name;
  }
  return base::fail("unknown synthetic trajectory '" + std::string(name) + "' (known: " + known + ")");
}

}  // namespace eg::synthetic
