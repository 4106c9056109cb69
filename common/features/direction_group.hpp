#pragma once

#include <optional>
#include <vector>

#include "common/features/direction_evidence.hpp"
#include "common/geometry/camera_model.hpp"

namespace eg::features {

struct DirectionGroupOptions {
  double max_pixel_error = 1.5;     ///< of a member's end points from the line to the vanishing point
  double max_sigmas = 3.0;          ///< of a member's direction in space from the group's
  double max_depth_angle = 0.07;    ///< radians: how far a member's direction in space may be off in any case
  int min_depth_lines = 2;          ///< members with depth that make a group
  int min_image_lines = 4;          ///< members that make a group where depth is missing
  double max_group_sigma = 0.0175;  ///< radians: a group's direction is known at least that well
};

/// Parallel lines.
struct DirectionGroup {
  DirectionEstimate estimate;
  std::vector<int> members;  ///< indices of the evidence, sorted
};

/// Whether a line agrees with a direction, in the image and (if it has depth) in space. `direction_sigma`, radians: the
/// direction's own uncertainty.
bool agrees(const DirectionEvidence& line, const Eigen::Vector3d& direction, double direction_sigma,
            const geometry::CameraModel& camera, const DirectionGroupOptions& options);

/// The depth check of the paper (section 4.1): RANSAC over the directions in space of a cluster of segments, and over
/// their vanishing point, for the direction that most of them (by length) share. Every hypothesis is refined on its
/// inliers, segments that disagree leave. The candidates are so few that all are tried: nothing is random. None if too
/// few agree.
std::optional<DirectionGroup> check_group(const std::vector<DirectionEvidence>& lines, const std::vector<int>& cluster,
                                          const geometry::CameraModel& camera, const DirectionGroupOptions& options);

/// The group refitted to the given members; none if they are too few or do not determine it.
std::optional<DirectionGroup> fit_group(const std::vector<DirectionEvidence>& lines, std::vector<int> members,
                                        const Eigen::Vector3d& initial, const DirectionGroupOptions& options);

}  // namespace eg::features
