#pragma once

#include <vector>

#include "common/features/plane_clustering.hpp"

namespace eg::features {

/// Two neighbouring blocks of different regions.
struct Contact {
  int region_a = 0;
  int region_b = 0;
  double step = 0;  ///< from a to b where they meet, along the ray; in limits of the tolerance
};

/// All contacts, across at most one unusable block: those on a crease are mixed and often rejected.
///
/// A block at a border holds pixels of both sides as often as not, and its plane then bridges the step. So the step is
/// measured between what the 3 x 3 blocks behind the border on either side foretell; where one region is not that
/// deep, between the other's forecast and the blocks themselves. Where a region's depth does not even change by one
/// step of a sensor's disparity, such a forecast would take the step for the course of the surface: there the blocks at
/// the border count.
std::vector<Contact> find_contacts(const BlockGrid& grid, const BlockClusters& clusters,
                                   const PlaneTolerance& step_tolerance);

}  // namespace eg::features
