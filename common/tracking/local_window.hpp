#pragma once

#include <vector>

#include "common/tracking/map.hpp"

namespace eg::tracking {

/// The part of the map that a local bundle adjustment moves. Every list is in ascending order.
struct LocalWindow {
  std::vector<KeyframeId> keyframes;
  std::vector<PointId> points;  ///< seen by one of the keyframes, and by another keyframe of the map
  std::vector<LineId> lines;
  std::vector<PlaneId> planes;

  [[nodiscard]] bool contains(KeyframeId id) const;
};

/// The newest keyframe and those `size - 1` that share the most features with it. Never the first one of the map, which
/// is the world.
LocalWindow local_window(const Map& map, KeyframeId newest, int size);

}  // namespace eg::tracking
