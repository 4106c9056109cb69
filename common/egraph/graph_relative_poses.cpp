#include <algorithm>
#include <utility>

#include "common/base/check.hpp"
#include "common/egraph/graph.hpp"

/// What was measured between keyframes of the graph.
namespace eg::egraph {
namespace {

using Key = std::pair<KeyframeId, KeyframeId>;

/// Nearly all keyframes are measured against older ones, so that the order by the younger is that of arrival.
Key key_of(const RelativePose& relative) {
  return {std::max(relative.first, relative.second), std::min(relative.first, relative.second)};
}

template <typename List>
auto lower_bound_by_key(List& relative_poses, const Key& key) {
  return std::lower_bound(relative_poses.begin(), relative_poses.end(), key,
                          [](const RelativePose& a, const Key& b) { return key_of(a) < b; });
}

}  // namespace

std::span<const RelativePose> Graph::relative_poses_from(KeyframeId oldest) const {
  return {lower_bound_by_key(relative_poses_, Key{oldest, KeyframeId{}}), relative_poses_.end()};
}

void Graph::put_relative_pose(const RelativePose& relative) {
  const Key key = key_of(relative);
  const auto it = lower_bound_by_key(relative_poses_, key);
  if (it != relative_poses_.end() && key_of(*it) == key) {
    *it = relative;
  } else {
    relative_poses_.insert(it, relative);
    measured_against_[key.second].push_back(key.first);
  }
}

void Graph::measure_again(KeyframeId moved) {
  const auto measure = [this](RelativePose& relative) {
    const KeyframeNode* first = find_keyframe(relative.first);
    const KeyframeNode* second = find_keyframe(relative.second);
    EG_CHECK(first != nullptr && second != nullptr, "relative poses are between keyframes of the graph");
    relative.first_from_second = first->world_from_camera.inverse() * second->world_from_camera;
  };
  auto against_older = lower_bound_by_key(relative_poses_, Key{moved, KeyframeId{}});
  for (; against_older != relative_poses_.end() && key_of(*against_older).first == moved; ++against_older) {
    measure(*against_older);
  }
  const auto younger = measured_against_.find(moved);
  if (younger == measured_against_.end()) return;
  for (const KeyframeId id : younger->second) measure(*lower_bound_by_key(relative_poses_, Key{id, moved}));
}

}  // namespace eg::egraph
