#include "services/viewer/trajectory_view.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "services/viewer/arrays.hpp"
#include "services/viewer/packet.hpp"

namespace eg::services {
namespace {

constexpr std::size_t kSamplesPerBlock = 64;
constexpr std::size_t kMaxSamples = 1'000'000;  ///< nine hours at 30 Hz

}  // namespace

void TrajectoryView::add(const tracking::PoseEstimate& estimate, const GraphView& graph) {
  if (estimate.header.sequence <= newest_sequence_) return;  // an answer that is repeated
  newest_sequence_ = estimate.header.sequence;
  if (oldest_sequence_ < 0) oldest_sequence_ = newest_sequence_;
  if (estimate.keyframe.valid()) keyframe_ = estimate.keyframe;
  const geometry::Pose* world_from_keyframe = graph.find_pose(keyframe_);
  if (!estimate.has_pose || world_from_keyframe == nullptr || samples_.size() >= kMaxSamples) {
    gap_ = true;
    return;
  }
  samples_.push_back({estimate.header.utime, keyframe_, world_from_keyframe->inverse() * estimate.world_from_camera,
                      !gap_, estimate.state});
  gap_ = false;
}

void TrajectoryView::take_missed(const GraphView& graph) {
  const auto nodes = graph.graph().keyframes();
  if (nodes.empty()) return;
  std::vector<Sample> missed;
  for (const egraph::KeyframeNode& node : nodes) {
    if (oldest_sequence_ >= 0 && node.sequence >= oldest_sequence_) break;
    missed.push_back({node.utime, node.id, {}, !missed.empty(), tracking::TrackingState::tracking});
    newest_sequence_ = std::max(newest_sequence_, node.sequence);
    keyframe_ = std::max(keyframe_, node.id);
  }
  if (missed.empty()) return;
  if (!samples_.empty()) samples_.front().follows = true;
  samples_.insert(samples_.begin(), missed.begin(), missed.end());
  oldest_sequence_ = nodes.front().sequence;
  gap_ = false;
  put_ = 0;
}

bool TrajectoryView::put(Board& board) {
  bool all = true;
  while (put_ < samples_.size()) {
    const std::size_t block = put_ / kSamplesPerBlock;
    const std::size_t begin = block * kSamplesPerBlock;
    const std::size_t end = std::min(begin + kSamplesPerBlock, samples_.size());
    std::vector<std::int32_t> keyframes;
    std::vector<float> positions;
    std::vector<std::uint8_t> follows, states;
    for (std::size_t i = begin; i < end; ++i) {
      const Sample& sample = samples_[i];
      keyframes.push_back(sample.keyframe.value);
      append(positions, sample.keyframe_from_camera.translation);
      follows.push_back(sample.follows ? 1 : 0);
      states.push_back(static_cast<std::uint8_t>(sample.state));
    }
    Packet packet("trajectory");
    packet.set("block", static_cast<double>(block))
        .array("keyframes", keyframes)
        .array("positions", positions)
        .array("follows", follows)
        .array("states", states);
    all = board.put(fmt::format("trajectory/{}", block), packet.bytes()) && all;
    put_ = end;
  }
  return all;
}

std::vector<geometry::StampedPose> TrajectoryView::poses(const GraphView& graph) const {
  std::vector<geometry::StampedPose> poses;
  for (const Sample& sample : samples_) {
    const geometry::Pose* world_from_keyframe = graph.find_pose(sample.keyframe);
    if (world_from_keyframe == nullptr) continue;
    poses.push_back({1e-6 * static_cast<double>(sample.utime), *world_from_keyframe * sample.keyframe_from_camera});
  }
  return poses;
}

}  // namespace eg::services
