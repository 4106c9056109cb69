#pragma once

#include <vector>

#include "common/egraph/graph_builder.hpp"
#include "common/tracking/tracker.hpp"
#include "tests/support/feature_world.hpp"

namespace eg::test {

/// Tracker and E-Graph server in one thread without a bus: what the services do, frame by frame.
class SlamLoop {
 public:
  explicit SlamLoop(const tracking::TrackerOptions& options = {}, const egraph::GraphBuilderOptions& graph = {})
      : tracker_(options), builder_(graph) {}

  /// Tracks a frame; a keyframe goes into the graph and the graph's update to the tracker.
  tracking::PoseEstimate step(const features::FrameFeatures& frame);

  [[nodiscard]] const std::vector<tracking::PoseEstimate>& estimates() const { return estimates_; }
  [[nodiscard]] const tracking::Tracker& tracker() const { return tracker_; }
  [[nodiscard]] const egraph::Graph& graph() const { return builder_.graph(); }
  /// How often a keyframe was moved by the refinement of the graph.
  [[nodiscard]] int corrections() const { return corrections_; }
  [[nodiscard]] const std::vector<egraph::Keyframe>& keyframes() const { return keyframes_; }

 private:
  tracking::Tracker tracker_;
  egraph::GraphBuilder builder_;
  std::vector<tracking::PoseEstimate> estimates_;
  std::vector<egraph::Keyframe> keyframes_;
  int corrections_ = 0;
};

/// How far the estimates are from the truth, over the frames that have a pose.
struct LoopErrors {
  int poses = 0;
  double worst_rotation = 0.0;     ///< radians
  double worst_translation = 0.0;  ///< metres
  double mean_rotation = 0.0;
  double mean_translation = 0.0;
};

LoopErrors errors(const std::vector<tracking::PoseEstimate>& estimates, const FeatureSequence& truth);

/// Every number of a result is finite, rotations are rotations and covariances symmetric and positive.
bool is_sound(const tracking::PoseEstimate& estimate);

}  // namespace eg::test
