#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/pose.hpp"
#include "common/image/rgbd_frame.hpp"
#include "common/mapping/tsdf_grids.hpp"
#include "common/mapping/tsdf_map.hpp"

namespace eg::mapping {

enum class Change { add, take_back };

struct IntegrationResult {
  IntegrationSummary summary;
  std::vector<Eigen::Vector3i> changed_leaves;  ///< origin / leaf side, in lexicographic order
};

/// Adds a frame to the sums or takes it back. The images have the camera's size; the pose is finite.
IntegrationResult integrate_frame(const image::RectifiedFrame& frame, const geometry::Pose& world_from_camera,
                                  const TsdfOptions& options, Change change, TsdfGrids& grids);

}  // namespace eg::mapping
