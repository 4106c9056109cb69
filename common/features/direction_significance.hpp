#pragma once

#include <vector>

#include "common/features/direction_evidence.hpp"
#include "common/features/direction_group.hpp"

namespace eg::features {

/// How many groups as parallel as this one are to be expected among `candidates` lines of random directions, as a
/// natural logarithm: the number of ways to choose its members times the probability that all of them agree with one of
/// them by chance (a contrario reasoning: Desolneux, Moisan, Morel, IJCV 2000). Two lines of five that are parallel
/// within a degree are a discovery, two of a hundred are not. A line agrees by chance in the image with the share of
/// angles that is let pass, and in space with the share of directions.
double log_false_alarms(const std::vector<DirectionEvidence>& lines, const DirectionGroup& group, int candidates,
                        const DirectionGroupOptions& options);

}  // namespace eg::features
