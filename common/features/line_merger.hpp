#pragma once

#include <vector>

#include "common/features/line_segment.hpp"

namespace eg::features {

struct LineMergerOptions {
  double max_offset = 1.0;     ///< across the longer segment, of the other's end points, pixels
  double max_gap = 10.0;       ///< between two pieces, pixels
  double max_gap_share = 0.5;  ///< of the shorter piece's length
};

/// Joins pieces of one broken edge: segments of the same polarity that continue each other within the bounds. The
/// longest segments come first in the result, and collect their continuations first. `segments` should be refined
/// (polarity).
std::vector<Segment> merge_collinear(std::vector<Segment> segments, const LineMergerOptions& options);

}  // namespace eg::features
