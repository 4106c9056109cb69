#include "common/mapping/tsdf_options.hpp"

namespace eg::mapping {

base::Status validate(const TsdfOptions& options) {
  const auto within = [](double value, double low, double high) { return value >= low && value <= high; };
  if (!within(options.voxel_size, 0.001, 1.0)) return base::fail("voxel_size must be in [0.001, 1] metres");
  if (!within(options.min_depth, 0.01, 100.0)) return base::fail("min_depth must be in [0.01, 100] metres");
  if (!within(options.max_depth, 0.02, 100.0) || options.max_depth <= options.min_depth) {
    return base::fail("max_depth must be above min_depth and at most 100 metres");
  }
  if (!within(options.truncation_voxels, 2.0, 64.0)) return base::fail("truncation_voxels must be in [2, 64]");
  if (!within(options.truncation_sigmas, 0.0, 10.0)) return base::fail("truncation_sigmas must be in [0, 10]");
  if (!within(options.max_gradient, 1.0, 1000.0)) return base::fail("max_gradient must be in [1, 1000]");
  if (options.shares < 1 || options.share < 0 || options.share >= options.shares) {
    return base::fail("share must be in [0, shares)");
  }
  return {};
}

}  // namespace eg::mapping
