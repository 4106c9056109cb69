#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>

#include "common/egraph/graph.hpp"
#include "common/egraph/snapshot_parts.hpp"
#include "common/tracking/pose_estimate.hpp"
#include "services/viewer/board.hpp"
#include "services/viewer/direction_colours.hpp"

namespace eg::services {

/// The viewer's replica of the E-Graph and where its keyframes are by the latest word on each.
class GraphView {
 public:
  /// False: an update before it is missing; somebody should ask for a snapshot.
  bool apply(const egraph::GraphUpdate& update);
  bool apply(const egraph::GraphSnapshot& part);
  void apply(const tracking::PoseCorrection& correction);
  /// A keyframe as the tracker has just announced it.
  void add_keyframe(egraph::KeyframeId id, const geometry::Pose& world_from_camera);
  void clear() { *this = {}; }

  [[nodiscard]] const egraph::Graph& graph() const { return graph_; }
  [[nodiscard]] const std::map<egraph::KeyframeId, geometry::Pose>& poses() const { return poses_; }
  [[nodiscard]] const geometry::Pose* find_pose(egraph::KeyframeId id) const;
  [[nodiscard]] const DirectionColours& colours() const { return colours_; }
  /// Counts the changes of known poses.
  [[nodiscard]] int corrections() const { return corrections_; }

  /// The direction away from the floor, unit, world frame: of the planes within 40 degrees of where the first camera
  /// has it, the normal that most keyframes have seen. `y_up`: the camera's fy is negative.
  [[nodiscard]] Eigen::Vector3d up(bool y_up) const;

  /// Packets "poses", in blocks.
  bool put_poses(Board& board) const;
  /// Packets "graph", in blocks, and "landmarks".
  bool put_graph(Board& board) const;

 private:
  void take_over_poses();
  void correct(egraph::KeyframeId id, const geometry::Pose& world_from_camera);

  egraph::Graph graph_;
  egraph::SnapshotAssembler parts_;
  std::map<egraph::KeyframeId, geometry::Pose> poses_;
  std::int64_t correction_version_ = -1;
  int corrections_ = 0;
  DirectionColours colours_;
};

}  // namespace eg::services
