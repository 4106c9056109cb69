#pragma once

#include <algorithm>

#include "common/base/result.hpp"
#include "common/geometry/depth_noise.hpp"

namespace eg::mapping {

/// How depth readings become a truncated signed distance field (TSDF).
struct TsdfOptions {
  double voxel_size = 0.02;        ///< distance between samples of the field, metres
  double min_depth = 0.3;          ///< nearer readings are ignored, metres
  double max_depth = 5.0;          ///< farther readings, of 4 cm noise and more, are ignored, metres
  double truncation_voxels = 3.0;  ///< the field is known up to this many voxels from a surface at least
  double truncation_sigmas = 2.0;  ///< and at least this many standard deviations of the reading
  double max_gradient = 3.0;  ///< a step above this many voxel sizes from voxel to voxel is a depth edge, no surface

  // Several maps may share the space: each knows what lies in its own tiles and, up to a leaf, around them.
  int share = 0;   ///< number of this map's share, from 0
  int shares = 1;  ///< how many maps there are

  bool operator==(const TsdfOptions&) const = default;
};

/// Says which option is out of range.
base::Status validate(const TsdfOptions& options);

/// How far in metres a reading at `depth` metres knows the distance from the surface. Farther behind the surface it
/// says nothing, farther before it that space is free.
inline double truncation(const TsdfOptions& options, double depth) {
  return std::max(options.truncation_voxels * options.voxel_size,
                  options.truncation_sigmas * geometry::depth_sigma(depth));
}

}  // namespace eg::mapping
