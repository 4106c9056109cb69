#pragma once

#include <span>

#include "common/egraph/association.hpp"
#include "common/egraph/graph.hpp"
#include "common/tracking/map.hpp"
#include "common/tracking/pose_optimizer.hpp"

namespace eg::tracking {

/// Error (pixels) with which a segment's detector places each of its end points across the segment.
inline constexpr double kLinePixelSigma = 1.0;
/// What calibration and warped depth leave between two views of one plane (metres).
inline constexpr double kPlaneHeightFloor = 0.003;

/// The image line through a segment: a u + b v + c = 0 in pixels, a² + b² = 1.
Eigen::Vector3d image_line(const features::LineFeature& line);

/// Covariance (pixels²) of the distances from that line where the start and the end of the landmark are projected to.
/// Little of a line may be seen, and beyond the seen part the error grows.
Eigen::Matrix2d image_line_covariance(const features::LineFeature& line, const geometry::CameraModel& camera,
                                      const geometry::Pose& camera_from_world, const Eigen::Vector3d& start_in_world,
                                      const Eigen::Vector3d& end_in_world);

/// The factors of matched points, with the uncertainty of the map added to that of the measurement.
std::vector<PointFactor> point_factors(const features::FrameFeatures& frame, const Map& map,
                                       std::span<const PointMatch> matches, const geometry::Pose& camera_from_world);

std::vector<LineFactor> line_factors(const features::FrameFeatures& frame, const Map& map,
                                     std::span<const LineMatch> matches, const geometry::Pose& camera_from_world);

std::vector<PlaneFactor> plane_factors(const features::FrameFeatures& frame, const Map& map,
                                       std::span<const PlaneMatch> matches, const geometry::Pose& camera_from_world);

std::vector<DirectionFactor> direction_factors(const features::FrameFeatures& frame, const egraph::Graph& graph,
                                               std::span<const egraph::Association> associations,
                                               const Eigen::Matrix3d& camera_from_world_rotation);

}  // namespace eg::tracking
