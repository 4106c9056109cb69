#pragma once

#include <vector>

#include "common/base/result.hpp"
#include "common/tracking/map.hpp"

namespace eg::tracking {

/// Where a keyframe is and what its features turned out to be.
struct KeyframeLinks {
  geometry::Pose world_from_camera;
  Matches matches;
  std::vector<egraph::Association> directions;
};

/// Where the landmarks of a map are, by id.
struct LandmarkPositions {
  struct Point {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world, metres
    bool alive = true;
  };
  struct Line {
    Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< world, metres
    Eigen::Vector3d end = Eigen::Vector3d::Zero();
    bool alive = true;
  };
  std::vector<Point> points;
  std::vector<Line> lines;
  std::vector<geometry::Plane> planes;  ///< world
};

/// A map as it is kept: the rest of it follows from this.
struct SavedMap {
  struct Keyframe {
    features::FrameFeatures features;
    KeyframeLinks links;
  };
  std::vector<Keyframe> keyframes;  ///< by id
  LandmarkPositions landmarks;
};

KeyframeLinks links_of(const MapKeyframe& keyframe);
LandmarkPositions positions_of(const Map& map);

/// The map again: keyframes, matches, positions and what was culled as they were; covariances anew from the keyframes'
/// measurements; how often a landmark was expected and found begins at zero. Refuses matches that contradict the
/// features or one another, naming the keyframe.
base::Result<Map> rebuild(const SavedMap& saved);

}  // namespace eg::tracking
