#include <algorithm>
#include <iterator>

#include "common/tracking/tracker.hpp"

/// The tracker and the E-Graph server: what one tells the other, and how the map follows a refined graph.
namespace eg::tracking {
namespace {

/// Moved keyframes in one message, so that it stays below 180 kB. Seldom more than a local window moves.
constexpr std::size_t kMaxReported = 80;

bool equal(const geometry::Pose& a, const geometry::Pose& b) {
  return a.rotation == b.rotation && a.translation == b.translation;
}

/// Where keyframe `id` was when the server refined the graph; `before` is the replica without the update.
const geometry::Pose* announced_pose(KeyframeId id, const egraph::GraphUpdate& update, const egraph::Graph& before) {
  if (id == update.keyframe.id) return &update.keyframe.world_from_camera;
  const auto moved =
      std::find_if(update.moved.begin(), update.moved.end(), [id](const auto& pose) { return pose.keyframe == id; });
  if (moved != update.moved.end()) return &moved->world_from_camera;
  const egraph::KeyframeNode* node = before.find_keyframe(id);
  return node == nullptr ? nullptr : &node->world_from_camera;
}

}  // namespace

void Tracker::report_moved_keyframes(egraph::Keyframe& keyframe) const {
  // The newest first: of the rest the server hears with the next keyframe.
  const std::span<const MapKeyframe> all = map_.keyframes();
  for (auto at = all.rbegin(); at != all.rend(); ++at) {
    const MapKeyframe& older = *at;
    const egraph::KeyframeNode* node = graph_.find_keyframe(older.id);
    if (node == nullptr || equal(node->world_from_camera, older.world_from_camera)) continue;
    if (keyframe.moved.size() == kMaxReported) break;
    keyframe.moved.push_back({older.id, older.world_from_camera});
  }
}

base::Result<std::vector<egraph::CorrectedPose>> Tracker::follow(const egraph::GraphUpdate& update) {
  if (update.version <= graph_.version()) return {};
  std::vector<KeyframeCorrection> corrections;
  for (const egraph::CorrectedPose& refined : update.corrections) {
    const geometry::Pose* announced = announced_pose(refined.keyframe, update, graph_);
    if (announced != nullptr) corrections.push_back({refined.keyframe, *announced, refined.world_from_camera});
  }
  if (const auto applied = graph_.apply(update); !applied) return tl::make_unexpected(applied.error());
  return correct_map(corrections, update.keyframe.id);
}

base::Result<std::vector<egraph::CorrectedPose>> Tracker::follow(const egraph::GraphSnapshot& snapshot) {
  if (const auto taken = graph_.reset(snapshot); !taken) return tl::make_unexpected(taken.error());
  std::vector<KeyframeCorrection> corrections;
  for (const egraph::KeyframeNode& node : graph_.keyframes()) {
    if (node.id.value >= static_cast<std::int32_t>(map_.keyframes().size())) break;
    const geometry::Pose& current = map_.keyframe(node.id).world_from_camera;
    if (!equal(current, node.world_from_camera)) corrections.push_back({node.id, current, node.world_from_camera});
  }
  const auto keyframes = graph_.keyframes();
  return correct_map(corrections, keyframes.empty() ? KeyframeId{} : keyframes.back().id);
}

std::vector<egraph::CorrectedPose> Tracker::correct_map(std::span<const KeyframeCorrection> corrections,
                                                        KeyframeId newest) {
  const auto known = static_cast<std::int32_t>(map_.keyframes().size());
  std::vector<KeyframeCorrection> of_map;
  std::copy_if(corrections.begin(), corrections.end(), std::back_inserter(of_map),
               [known](const auto& correction) { return correction.keyframe.value < known; });
  std::vector<egraph::CorrectedPose> poses = corrected_poses(map_, of_map, newest);
  if (poses.empty()) return poses;
  const MapKeyframe& last = map_.keyframes().back();
  if (poses.back().keyframe == last.id) {
    const geometry::Pose moved = poses.back().world_from_camera * last.world_from_camera.inverse();
    motion_.correct_by(moved);
    direction_tracks_.turn(moved.rotation);
  }
  move_with_keyframes(poses, map_);
  return poses;
}

}  // namespace eg::tracking
