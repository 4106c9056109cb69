#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/pose.hpp"
#include "common/image/rgbd_frame.hpp"
#include "common/mapping/depth_view.hpp"
#include "common/mapping/tsdf_options.hpp"

namespace eg::mapping {

/// Numbers (origin / leaf side) of the leaves of `leaf_side`³ voxels in which a reading's ray comes within the
/// truncation distance of what the reading shows, and a few beside them, in lexicographic order.
std::vector<Eigen::Vector3i> leaves_near_surface(const DepthView& view, const geometry::CameraModel& camera,
                                                 const geometry::Pose& world_from_camera, const TsdfOptions& options,
                                                 int leaf_side);

}  // namespace eg::mapping
