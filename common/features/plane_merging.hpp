#pragma once

#include <vector>

#include "common/features/plane_clustering.hpp"

namespace eg::features {

/// Joins regions that touch without a step and are one plane within a wider tolerance: real walls are wavy, and the
/// sensor bends flat ones. `step_tolerance` is for the rms step along their border.
void merge_continuous(const BlockGrid& grid, const PlaneTolerance& tolerance, const PlaneTolerance& step_tolerance,
                      BlockClusters& clusters);

/// Errors of the depth that neighbouring pixels share.
struct SharedError {
  double sigma = 0;   ///< standard deviations of one reading
  double pixels = 0;  ///< that have one such error in common
};
using SharedErrors = std::vector<SharedError>;

/// Joins regions that lie on one plane but do not touch (a wall behind a pillar): their common plane fits either, and
/// `errors` explain the difference of their own planes. Where regions touch, merge_continuous has decided already.
void merge_coplanar(const BlockGrid& grid, const PlaneTolerance& tolerance, const SharedErrors& errors,
                    BlockClusters& clusters);

/// Replaces every index i >= 0 by new_index[i].
void renumber(const std::vector<int>& new_index, std::vector<int>& indices);

}  // namespace eg::features
