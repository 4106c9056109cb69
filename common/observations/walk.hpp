#pragma once

#include <cstdint>

#include "common/geometry/camera_model.hpp"
#include "common/observations/frame_features.hpp"
#include "common/observations/recording.hpp"

namespace eg::observations {

struct WalkOptions {
  int rooms = 10;
  double seconds_per_room = 60.0;
  std::uint64_t seed = 1;  ///< of the landmarks and of the noise
};

/// A walk through a row of rooms from one into the next, once through each, turning around three times in every room:
/// nothing is ever seen again that was left behind. Rooms are boxes with corners on their walls, edges, and boards;
/// walls hide what is behind them except through the doors. Pixels and the depths of lines have the noise of `sensor`.
/// World: z up, metres.
Recording make_walk(const geometry::CameraModel& camera, const SensorModel& sensor, const WalkOptions& options = {});

}  // namespace eg::observations
