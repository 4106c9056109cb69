#pragma once

#include <vector>

#include "common/tracking/bundle_residuals.hpp"
#include "common/tracking/map.hpp"

namespace eg::tracking {

// What a frame measured of a landmark, without the map's uncertainty: in a bundle adjustment the landmark is free.

/// The errors of a depth image are those of warped patches, not of single pixels: the points of one patch have their
/// error in common and count as one. Returns, for each point, how many points with depth lie in its patch.
std::vector<int> points_in_same_patch(const features::FrameFeatures& frame);

// Beside an occluding edge the depth may be that of the other surface. A depth that the landmark's present place
// contradicts (95 % quantile, as in the frame-to-map refinement) is left out; the place in the image still counts.

/// `sharing_depth_error`: points that count as one depth measurement.
PointFactor observed_point(const features::PointFeature& feature, const Eigen::Vector3d& point_in_world,
                           const geometry::Pose& camera_from_world, int sharing_depth_error);

LineObservation observed_line(const features::LineFeature& feature, const Eigen::Vector3d& start_in_world,
                              const Eigen::Vector3d& end_in_world, const geometry::CameraModel& camera,
                              const geometry::Pose& camera_from_world);

PlaneObservation observed_plane(const features::PlaneFeature& feature);

}  // namespace eg::tracking
