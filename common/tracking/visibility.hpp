#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/geometry/pose.hpp"
#include "common/tracking/map.hpp"

/// What of the map a camera can be expected to see.
namespace eg::tracking {

/// Where a map point is expected in the image, and how large.
struct ExpectedPoint {
  Eigen::Vector2d pixel;
  double octave = 0.0;  ///< level of the extractor's pyramid on which it should be found
};

/// Nothing if the point is behind the camera, outside the image, or seen from too far aside of where it was made.
std::optional<ExpectedPoint> expect_point(const MapPoint& point, const geometry::CameraModel& camera,
                                          const geometry::Pose& camera_from_world);

/// A segment in the image, pixels; its ends may be outside the picture.
struct ImageSegment {
  Eigen::Vector2d start;
  Eigen::Vector2d end;
};

/// The part of a map segment in front of the camera, projected.
std::optional<ImageSegment> project_segment(const MapLine& line, const geometry::CameraModel& camera,
                                            const geometry::Pose& camera_from_world);

/// The candidates that the pose puts into the image.
std::vector<PointId> visible_points(const geometry::CameraModel& camera, const Map& map,
                                    std::span<const PointId> candidates, const geometry::Pose& camera_from_world);

/// The candidates of which the pose puts so long a piece into the image that a detector should find it.
std::vector<LineId> visible_lines(const geometry::CameraModel& camera, const Map& map,
                                  std::span<const LineId> candidates, const geometry::Pose& camera_from_world);

}  // namespace eg::tracking
