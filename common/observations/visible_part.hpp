#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/geometry/camera_model.hpp"

namespace eg::observations {

struct Segment3 {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< camera frame, metres
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
};

/// The part of a segment whose image is within a margin of two pixels inside the picture and whose depth is between
/// `nearest` and `furthest`; none if there is none. Nothing is in front of it.
std::optional<Segment3> visible_part(Segment3 segment, const geometry::CameraModel& camera, double nearest,
                                     double furthest);

}  // namespace eg::observations
