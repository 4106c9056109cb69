#pragma once

#include "common/mapping/tsdf_options.hpp"

namespace eg::services {

struct MapperOptions {
  mapping::TsdfOptions tsdf;
  int memory_mb = 192;       ///< what the voxels may take; with an output folder the rest waits there. 0: no limit
  int image_budget = 256;    ///< compressed keyframe images kept for corrections, MB
  double mesh_period = 1.0;  ///< seconds between two updates of the mesh on the bus; 0: none
  bool plane_regularisation = true;  ///< take noise out of readings on the planes of FEATURES before fusing them
  bool resume = false;               ///< go on from the journal in the output folder
};

}  // namespace eg::services
