#pragma once

#include "common/base/result.hpp"
#include "common/eval/statistics.hpp"
#include "common/eval/surface.hpp"

namespace eg::eval {

struct MeshErrorOptions {
  double spacing_m = 0.02;  ///< of the samples on triangles; distances are to the triangles themselves, not to samples
};

/// Distances from one surface to another, every piece of surface weighted by its area.
struct SurfaceDistances {
  ErrorStatistics distance_m;
  double share_within_1cm = 0.0;  ///< of the area, in [0, 1]
  double share_within_5cm = 0.0;
};

struct MeshErrors {
  SurfaceDistances accuracy;      ///< from the estimate to the reference: is what was built true?
  SurfaceDistances completeness;  ///< from the reference to the estimate: was what is there built?
};

/// Compares two surfaces in the same frame. Fails if one of them has no points or no area.
base::Result<MeshErrors> evaluate_mesh(const SurfaceView& estimate, const SurfaceView& reference,
                                       const MeshErrorOptions& options = {});

}  // namespace eg::eval
