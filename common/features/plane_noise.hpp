#pragma once

#include "common/features/plane_blocks.hpp"
#include "common/features/plane_tolerance.hpp"

namespace eg::features {

/// How the depth errors of a frame compare with geometry::depth_sigma, by how far they reach in the image. A rendered
/// image has none; noise is the same at all distances but averages out; the ripples that structured light puts on flat
/// walls do not average out.
struct DepthErrors {
  double noise = 1.0;     ///< of pixels from the plane of their block, rms; between 1/3 and 1
  double waviness = 1.0;  ///< of blocks' means from the plane of 4 x 4 blocks, rms; between 1/20 and 1
  double warp = 1.0;      ///< the part of the waviness that is no noise: what grows from 2 x 2 to 4 x 4 blocks
};

/// Medians over the flat parts of the image, so that furniture does not pass for noise. Where too little is flat to
/// tell, the errors are those of a real sensor.
DepthErrors measure_depth_errors(const BlockGrid& grid, const PlaneTolerance& tolerance);

}  // namespace eg::features
