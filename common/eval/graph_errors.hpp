#pragma once

#include <cstddef>
#include <span>

#include "common/base/result.hpp"
#include "common/eval/statistics.hpp"
#include "common/geometry/camera_model.hpp"
#include "common/geometry/pose.hpp"

namespace eg::eval {

/// Two keyframes that share directions, as indices into the list of keyframes.
struct GraphEdge {
  std::size_t first = 0;
  std::size_t second = 0;
};

struct GraphErrorOptions {
  geometry::CameraModel camera;         ///< its field of view decides what overlaps; required
  double max_time_difference_s = 0.02;  ///< between a keyframe and its reference pose
  double nearest_m = 0.3;               ///< a depth camera measures from here
  double farthest_m = 8.0;              ///< to here
};

/// The rotation error of every edge of the E-Graph, degrees: the angle between the estimated and the true relative
/// rotation of its keyframes. Views overlap if the true view frusta, from the nearest to the farthest measurable
/// distance, have a point in common. Walls are not considered, so a pair counted as not overlapping has certainly seen
/// nothing in common, while some of the pairs counted as overlapping have not either.
struct GraphErrors {
  std::size_t keyframes = 0;
  std::size_t edges = 0;
  std::size_t edges_without_reference = 0;  ///< a keyframe of theirs has no reference pose at its time
  ErrorStatistics all_deg;
  ErrorStatistics overlapping_deg;
  ErrorStatistics non_overlapping_deg;
};

/// Keyframes and reference in increasing time. Fails if no keyframe has a reference pose at its time.
base::Result<GraphErrors> evaluate_graph(std::span<const geometry::StampedPose> keyframes,
                                         std::span<const GraphEdge> edges,
                                         std::span<const geometry::StampedPose> reference,
                                         const GraphErrorOptions& options);

}  // namespace eg::eval
