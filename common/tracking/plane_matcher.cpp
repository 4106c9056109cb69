#include <cmath>

#include "common/tracking/matcher.hpp"

namespace eg::tracking {

using features::FrameFeatures;
using geometry::Pose;

std::vector<PlaneMatch> match_planes(const FrameFeatures& frame, const Map& map, const Pose& camera_from_world,
                                     double position_sigma, const MatchOptions& options) {
  const Pose world_from_camera = camera_from_world.inverse();
  std::vector<PlaneMatch> matches;
  for (std::size_t i = 0; i < frame.planes.size(); ++i) {
    const features::PlaneFeature& feature = frame.planes[i];
    const PlaneEstimate observed{feature.plane, feature.covariance};
    const Eigen::Vector3d normal_in_world = world_from_camera.rotation * feature.plane.normal;
    const Eigen::Vector3d centroid_in_world = world_from_camera * feature.centroid;
    PlaneMatch best{static_cast<std::int32_t>(i), {}};
    double best_chi2 = options.max_plane_chi2;
    for (const MapPlane& plane : map.planes()) {
      const double cosine = normal_in_world.dot(plane.estimate.plane.normal);
      const double height = plane.estimate.plane.signed_distance(centroid_in_world);
      if (cosine < std::cos(options.max_plane_angle) || std::abs(height) > options.max_plane_distance) continue;
      const double variance = height_variance(plane.estimate, centroid_in_world) +
                              height_variance(observed, feature.centroid) + position_sigma * position_sigma;
      const double chi2 = height * height / variance;
      if (chi2 < best_chi2) {
        best_chi2 = chi2;
        best.id = plane.id;
      }
    }
    if (best.id.valid()) matches.push_back(best);
  }
  return matches;
}

}  // namespace eg::tracking
