#include "services/mapper/mapper_config.hpp"

namespace eg::services {

void describe_options(io::ConfigSchema& section, MapperOptions& options) {
  mapping::TsdfOptions& tsdf = options.tsdf;
  section.field("voxel_size", tsdf.voxel_size, {0.001, 1.0}, "metres")
      .field("min_depth", tsdf.min_depth, {0.01, 100.0}, "metres; nearer readings are ignored")
      .field("max_depth", tsdf.max_depth, {0.02, 100.0}, "metres; farther readings are ignored")
      .field("truncation_voxels", tsdf.truncation_voxels, {2.0, 64.0},
             "the field reaches as far from a surface, at least")
      .field("truncation_sigmas", tsdf.truncation_sigmas, {0.0, 10.0}, "the same in standard deviations of the reading")
      .field("max_gradient", tsdf.max_gradient, {1.0, 1000.0}, "a steeper step from voxel to voxel is a depth edge")
      .field("memory_mb", options.memory_mb, {0, 1'000'000},
             "MB that the voxels may take; the rest waits in the output folder; 0: no limit")
      .field("image_budget", options.image_budget, {0, 100'000}, "MB of keyframe images kept for corrections")
      .field("mesh_period", options.mesh_period, {0.0, 3600.0}, "seconds between mesh updates on the bus; 0: none")
      .field("plane_regularisation", options.plane_regularisation,
             "take noise out of depth readings that lie on planes of the frame's features");
}

}  // namespace eg::services
