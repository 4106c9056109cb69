#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/tracking/map.hpp"
#include "common/tracking/matcher.hpp"

namespace eg::tracking {

struct RelocaliserOptions {
  MatchOptions matching{.max_descriptor_distance = 56, .max_distance_ratio = 0.8};
  int samples = 200;          ///< triples of correspondences that are tried
  double inlier_chi2 = 9.21;  ///< 99 % quantile of chi²(2)
  int min_inliers = 20;       ///< places that look alike share a few corners, not twenty in one arrangement
  std::uint64_t seed = 2;
};

/// The camera_from_world that aligns three or more points of the world with those in the camera (Umeyama 1991, no
/// scale).
geometry::Pose align_points(std::span<const Eigen::Vector3d> in_world, std::span<const Eigen::Vector3d> in_camera);

/// Finds the camera without a prediction: descriptor matches with one keyframe, then RANSAC over triples of points with
/// depth. Nothing if too few agree.
std::optional<geometry::Pose> relocalise(const features::FrameFeatures& frame, const Map& map,
                                         const MapKeyframe& keyframe, const RelocaliserOptions& options = {});

}  // namespace eg::tracking
