#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <vector>

#include "common/geometry/pose.hpp"

/// Recordings at the level of features: what was seen where, with the landmarks' identities, and no images.
namespace eg::observations {

struct PointObservation {
  std::int32_t id = -1;                             ///< of the landmark
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< measured, undistorted
  double true_depth = 0.0;                          ///< z of the landmark in the true camera, metres
};

/// A segment of a straight line. From frame to frame the end points slide along the line.
struct LineObservation {
  std::int32_t id = -1;                                   ///< of the landmark
  Eigen::Vector2d start_pixel = Eigen::Vector2d::Zero();  ///< measured, undistorted
  Eigen::Vector2d end_pixel = Eigen::Vector2d::Zero();
  double start_depth = 0.0;  ///< measured z, metres
  double end_depth = 0.0;
};

struct RecordedFrame {
  double time_s = 0.0;
  geometry::Pose world_from_camera;  ///< true
  std::vector<PointObservation> points;
  std::vector<LineObservation> lines;
};

struct Recording {
  std::vector<RecordedFrame> frames;                 ///< in increasing time
  std::map<std::int32_t, std::int32_t> line_groups;  ///< by line: its group of lines that are parallel in the world
};

}  // namespace eg::observations
