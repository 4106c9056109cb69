#pragma once

#include <algorithm>

#include "common/base/result.hpp"
#include "common/geometry/depth_noise.hpp"

namespace eg::mapping {

/// How depth readings become a truncated signed distance field (TSDF).
struct TsdfOptions {
  double voxel_size = 0.02;   ///< distance between samples of the field, metres
  double min_depth = 0.3;     ///< nearer readings are ignored, metres
  double max_depth = 5.0;     ///< farther readings are ignored, metres
  double band_voxels = 4.0;   ///< half width of the band around a reading that is updated: at least this many voxels
  double band_sigmas = 3.0;   ///< and at least this many standard deviations of the reading
  double max_gradient = 3.0;  ///< a step above this many voxel sizes from voxel to voxel is a depth edge, no surface

  bool operator==(const TsdfOptions&) const = default;
};

/// Says which option is out of range.
base::Status validate(const TsdfOptions& options);

/// Half width in metres of the band that a reading at `depth` metres updates; beyond it the reading says nothing.
inline double band_half_width(const TsdfOptions& options, double depth) {
  return std::max(options.band_voxels * options.voxel_size, options.band_sigmas * geometry::depth_sigma(depth));
}

}  // namespace eg::mapping
