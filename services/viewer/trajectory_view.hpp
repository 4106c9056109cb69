#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/pose.hpp"
#include "common/tracking/pose_estimate.hpp"
#include "services/viewer/board.hpp"
#include "services/viewer/graph_view.hpp"

namespace eg::services {

/// Where the camera was, frame by frame, each pose kept relative to the latest keyframe before it, so that corrections
/// of keyframes move the trajectory too.
class TrajectoryView {
 public:
  /// A new frame. Frames without a pose leave a gap.
  void add(const tracking::PoseEstimate& estimate, const GraphView& graph);
  /// Where the camera was before the first frame seen: at the keyframes that the graph has from that time.
  void take_missed(const GraphView& graph);
  void clear() { *this = {}; }

  /// Packets "trajectory": the blocks that changed since the last call.
  bool put(Board& board);

  /// The poses as they are now, in increasing time.
  [[nodiscard]] std::vector<geometry::StampedPose> poses(const GraphView& graph) const;
  [[nodiscard]] std::int64_t newest_sequence() const { return newest_sequence_; }

 private:
  struct Sample {
    std::int64_t utime = 0;
    egraph::KeyframeId keyframe;
    geometry::Pose keyframe_from_camera;
    bool follows = false;  ///< on the frame before it, without a gap
    tracking::TrackingState state = tracking::TrackingState::tracking;
  };

  std::vector<Sample> samples_;
  std::size_t put_ = 0;  ///< samples that are on the board
  egraph::KeyframeId keyframe_;
  std::int64_t oldest_sequence_ = -1;  ///< -1: none seen yet
  std::int64_t newest_sequence_ = -1;
  bool gap_ = true;
};

}  // namespace eg::services
