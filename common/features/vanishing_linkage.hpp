#pragma once

#include <vector>

#include "common/features/vanishing_preferences.hpp"

namespace eg::features {

/// J-Linkage (Toldo and Fusiello, ECCV 2008): merges, again and again, the two clusters whose preference sets have the
/// smallest Jaccard distance; a cluster's set is the intersection of its members'. Stops when all sets are disjoint, so
/// that the number of clusters needs no threshold. Returns the cluster of every element; clusters are numbered by their
/// first element. Ties go to the clusters of the earliest elements.
std::vector<int> j_linkage(std::vector<PreferenceSet> sets);

}  // namespace eg::features
