#pragma once

#include <span>

#include "common/egraph/association.hpp"
#include "common/egraph/graph.hpp"
#include "common/tracking/map.hpp"
#include "common/tracking/pose_optimizer.hpp"

namespace eg::tracking {

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
