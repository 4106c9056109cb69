#pragma once

#include "common/features/features.hpp"

namespace eg::tracking {

/// The parts of the method that can be left out, to see what each is worth (docs/benchmarks.md, ablation).
struct TrackerParts {
  bool egraph = true;      ///< rotation from the directions of the E-Graph; without it from the prediction and the map
  bool lines = true;       ///< lines, vanishing and potential directions
  bool planes = true;      ///< planes and their normals
  bool refinement = true;  ///< of all six unknowns; without it the rotation of the E-Graph is final
  bool local_bundle_adjustment = true;
};

/// The frame as an extractor without these parts would have made it.
features::FrameFeatures without_missing(features::FrameFeatures frame, const TrackerParts& parts);

}  // namespace eg::tracking
