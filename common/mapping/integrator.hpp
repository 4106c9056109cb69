#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/pose.hpp"
#include "common/image/rgbd_frame.hpp"
#include "common/mapping/leaf_observer.hpp"
#include "common/mapping/tsdf_grids.hpp"
#include "common/mapping/tsdf_map.hpp"

namespace eg::mapping {

enum class Change { add, take_back };

struct IntegrationResult {
  IntegrationSummary summary;
  std::vector<Eigen::Vector3i> changed_leaves;  ///< origin / leaf side, in lexicographic order
};

/// A frame that is to be added to the sums or taken back. The images have the camera's size; the pose is finite.
class FrameChange {
 public:
  FrameChange(const image::RectifiedFrame& frame, const geometry::Pose& world_from_camera, const TsdfOptions& options);

  /// Numbers (origin / leaf side) of the leaves that it may change, in lexicographic order.
  [[nodiscard]] const std::vector<Eigen::Vector3i>& leaves() const { return leaves_; }

  /// Those of the leaves that exist must be in the trees.
  IntegrationResult apply(Change change, TsdfGrids& grids) const;

 private:
  LeafObserver observer_;
  std::vector<Eigen::Vector3i> leaves_;
};

}  // namespace eg::mapping
