#pragma once

#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/geometry/pose.hpp"

namespace eg::synthetic {

/// One coordinate of a motion: offset + rate t + sum of amplitude sin(2 pi (t / period + phase)).
struct Channel {
  struct Wave {
    double amplitude = 0.0;
    double period_s = 1.0;
    double phase = 0.0;  ///< in turns
  };
  double offset = 0.0;
  double rate = 0.0;  ///< per second
  std::vector<Wave> waves = {};

  [[nodiscard]] double at(double t) const;
};

/// A camera motion in closed form, smooth of every order, for all t (it stays within the scene's free space).
/// Angles in radians: `heading` about the world's z axis from +x, `tilt` downwards, `roll` about the optical axis.
struct Trajectory {
  std::string name;
  double duration_s = 30.0;        ///< how long it is worth watching
  Channel x = {}, y = {}, z = {};  ///< camera centre in the world, metres
  Channel heading = {}, tilt = {}, roll = {};

  /// Camera frame: x right, y down, z forward. World: z up.
  [[nodiscard]] geometry::Pose world_from_camera(double t) const;
};

/// The names make_trajectory() knows: one for every scene, of the same name, and `spin`: a pure rotation of 360 degrees
/// in the middle of any scene.
std::vector<std::string> trajectory_names();

/// At most about 0.5 m/s and 40 degrees/s; at least 0.5 m from every surface of its scene. Fails on an unknown name.
base::Result<Trajectory> make_trajectory(std::string_view name);

}  // namespace eg::synthetic
