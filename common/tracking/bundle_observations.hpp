#pragma once

#include <vector>

#include "common/tracking/bundle_residuals.hpp"
#include "common/tracking/map.hpp"

namespace eg::tracking {

// What a frame measured of a landmark, without the map's uncertainty: in a bundle adjustment the landmark is free.

/// The errors of a depth image are those of warped patches, not of single pixels: the points of one patch have their
/// error in common and count as one. Returns, for each point, how many points with depth lie in its patch.
std::vector<int> points_in_same_patch(const features::FrameFeatures& frame);

/// The point's place in the world is left open. `sharing_depth_error`: points that count as one depth measurement.
PointFactor observed_point(const features::PointFeature& feature, int sharing_depth_error);

LineObservation observed_line(const features::LineFeature& feature);

PlaneObservation observed_plane(const features::PlaneFeature& feature);

}  // namespace eg::tracking
