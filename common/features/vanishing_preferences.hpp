#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "common/features/line_segment.hpp"
#include "common/geometry/camera_model.hpp"

namespace eg::features {

inline constexpr int kMaxHypotheses = 512;

/// The vanishing direction hypotheses that a segment (or every segment of a cluster) agrees with: one bit each.
using PreferenceSet = std::array<std::uint64_t, kMaxHypotheses / 64>;

/// A segment as vanishing directions see it.
struct DirectionalSegment {
  Eigen::Vector3d plane_normal = Eigen::Vector3d::Zero();  ///< unit: of the plane of the camera and the segment
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();        ///< pixels
  Eigen::Vector2d half = Eigen::Vector2d::Zero();          ///< from the middle to the end, pixels
};

DirectionalSegment directional(const Segment& segment, const geometry::CameraModel& camera);

/// Consistency error of a segment with a vanishing direction (Tardif, ICCV 2009, section 3.2): the distance in pixels
/// of its end points from the line through its middle and the vanishing point. Directions parallel to the image are as
/// good as any.
double vanishing_error(const DirectionalSegment& segment, const Eigen::Vector3d& direction,
                       const geometry::CameraModel& camera);

/// Draws vanishing directions as the intersections of random pairs of segments, and says which of them every segment
/// agrees with within `max_error` pixels.
std::vector<PreferenceSet> preference_sets(const std::vector<DirectionalSegment>& segments,
                                           const geometry::CameraModel& camera, int hypotheses, double max_error,
                                           std::uint64_t seed);

}  // namespace eg::features
