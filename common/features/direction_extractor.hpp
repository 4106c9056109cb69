#pragma once

#include <cstdint>
#include <vector>

#include "common/base/result.hpp"
#include "common/features/direction_group.hpp"
#include "common/features/features.hpp"
#include "common/features/line_extractor.hpp"
#include "common/geometry/camera_model.hpp"

namespace eg::features {

struct DirectionExtractorOptions {
  int hypotheses = 500;            ///< of J-Linkage
  double max_linkage_error = 1.5;  ///< pixels, for a segment to prefer a hypothesis
  DirectionGroupOptions group;
  double same_direction = 0.12;  ///< radians: what is nearer to a better supported direction is no direction of its own
  double max_false_alarms = 0.1;  ///< groups per frame that are parallel by chance (log_false_alarms)
  double sigma_floor = 0.0007;    ///< radians per axis, added to every direction: what no model of noise knows
  double warp_sigma = 0.02;  ///< radians per axis, added times the depth's warp: what lenses, shutters and blur bend
  double max_potential_sigma = 0.02;  ///< radians: single lines known less well are no potential directions
  int max_potential = 20;             ///< potential directions per frame, the longest lines
  std::uint64_t seed = 1;
};

/// Names the first option that is out of range.
base::Status validate(const DirectionExtractorOptions& options);

/// The vanishing and potential directions of a frame's lines (paper, section 4.1): J-Linkage of the segments, the depth
/// check of every cluster, groups of one direction joined, every line given to the group it fits best, and single lines
/// that are known well enough as potential directions. No assumption on how many directions there are or on the angles
/// between them. Sets `feature.direction` of the lines. The vanishing directions come first, the best supported first.
std::vector<DirectionFeature> extract_line_directions(std::vector<MeasuredLine>& lines,
                                                      const geometry::CameraModel& camera,
                                                      const DirectionExtractorOptions& options = {});

/// Adds to the covariances what the frame's depth tells of its sensor (DepthErrors::warp): edges of a rendered image
/// are where they should be, those of a real camera are not.
void add_warp(double warp, const DirectionExtractorOptions& options, std::vector<DirectionFeature>& line_directions);

/// One direction per plane: its normal with its covariance.
std::vector<DirectionFeature> plane_directions(const std::vector<PlaneFeature>& planes);

}  // namespace eg::features
