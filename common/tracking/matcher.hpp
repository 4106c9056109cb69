#pragma once

#include <span>
#include <vector>

#include "common/features/features.hpp"
#include "common/tracking/map.hpp"

namespace eg::tracking {

struct MatchOptions {
  double radius = 15.0;              ///< pixels around the predicted place, on the finest pyramid level
  int max_descriptor_distance = 64;  ///< of 256 bits; unrelated descriptors differ in 128 +- 8
  double max_distance_ratio = 0.85;  ///< best against second best
  double max_line_angle = 0.10;      ///< radians (6°) between predicted and observed segment
  int max_line_descriptor_distance = 90;
  double max_plane_angle = 0.17;     ///< radians (10°)
  double max_plane_distance = 0.10;  ///< metres, at the region's centroid
  double max_plane_chi2 = 16.27;     ///< of that distance: four standard deviations
};

/// The number of bits in which two descriptors differ.
int hamming_distance(const features::Descriptor& a, const features::Descriptor& b);

/// Looks for map points near the places where the predicted pose puts them. One to one. A known track id decides by
/// itself, and of landmarks that share one, the oldest is meant: newer ones came from views that did not agree with it.
std::vector<PointMatch> match_points(const features::FrameFeatures& frame, const Map& map,
                                     std::span<const PointId> candidates, const geometry::Pose& camera_from_world,
                                     const MatchOptions& options = {});

/// Looks for map segments along the places where the predicted pose puts them. One to one. Track ids as above.
std::vector<LineMatch> match_lines(const features::FrameFeatures& frame, const Map& map,
                                   std::span<const LineId> candidates, const geometry::Pose& camera_from_world,
                                   const MatchOptions& options = {});

/// Gives every plane of the frame to the map plane that fits best. Several regions may lie on one border-less plane.
/// `position_sigma`: metres, how well the predicted position is known.
std::vector<PlaneMatch> match_planes(const features::FrameFeatures& frame, const Map& map,
                                     const geometry::Pose& camera_from_world, double position_sigma,
                                     const MatchOptions& options = {});

/// Matches by descriptor alone between a frame and a keyframe's points, mutually best. For when there is no prediction.
std::vector<PointMatch> match_points_by_descriptor(const features::FrameFeatures& frame, const Map& map,
                                                   const MapKeyframe& keyframe, const MatchOptions& options = {});

}  // namespace eg::tracking
