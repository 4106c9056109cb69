#include "common/egraph/graph.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "common/egraph/rotation_solver.hpp"
#include "common/geometry/so3.hpp"

namespace eg::egraph {
namespace {

template <typename Node, typename Id>
auto lower_bound_by_id(Node& nodes, Id id) {
  return std::lower_bound(nodes.begin(), nodes.end(), id, [](const auto& node, Id value) { return node.id < value; });
}

base::Status unknown_landmark(LandmarkId id) {
  return base::fail("graph holds an observation of landmark " + std::to_string(id.value) + ", which does not exist");
}

}  // namespace

base::Status Graph::apply(const GraphUpdate& update) {
  if (update.version <= version_) return {};
  if (update.base_version != version_) {
    return base::fail("graph update starts at version " + std::to_string(update.base_version) + ", the graph is at " +
                      std::to_string(version_));
  }
  if (!keyframes_.empty() && update.keyframe.id <= keyframes_.back().id) {
    return base::fail("graph update brings keyframe " + std::to_string(update.keyframe.id.value) + " a second time");
  }
  for (const Observation& observation : update.observations) {
    const auto is_observed = [&](const DirectionLandmark& landmark) { return landmark.id == observation.landmark; };
    if (find_landmark(observation.landmark) == nullptr &&
        std::none_of(update.landmarks.begin(), update.landmarks.end(), is_observed)) {
      return unknown_landmark(observation.landmark);
    }
  }
  version_ = update.version;
  keyframes_.push_back(update.keyframe);
  for (const DirectionLandmark& landmark : update.landmarks) put_landmark(landmark);
  for (const Observation& observation : update.observations) put_observation(observation);
  for (const LandmarkId id : update.removed) remove_landmark(id);
  edges_.insert(edges_.end(), update.edges.begin(), update.edges.end());
  for (const Covisibility& covisible : update.covisible) {
    covisibility_.push_back({covisible.keyframe, update.keyframe.id, covisible.shared_features});
  }
  return {};
}

base::Status Graph::reset(const GraphSnapshot& snapshot) {
  Graph graph;
  graph.version_ = snapshot.version;
  graph.keyframes_ = snapshot.keyframes;
  graph.edges_ = snapshot.edges;
  graph.covisibility_ = snapshot.covisibility;
  std::sort(graph.keyframes_.begin(), graph.keyframes_.end(),
            [](const KeyframeNode& a, const KeyframeNode& b) { return a.id < b.id; });
  for (const DirectionLandmark& landmark : snapshot.landmarks) graph.put_landmark(landmark);
  for (const Observation& observation : snapshot.observations) {
    if (graph.find_landmark(observation.landmark) == nullptr) return unknown_landmark(observation.landmark);
    graph.put_observation(observation);
  }
  *this = std::move(graph);
  return {};
}

GraphSnapshot Graph::snapshot(std::int64_t session) const {
  return {session, version_, keyframes_, landmarks_, observations_, edges_, covisibility_};
}

const DirectionLandmark* Graph::find_landmark(LandmarkId id) const {
  const auto it = lower_bound_by_id(landmarks_, id);
  return it != landmarks_.end() && it->id == id ? &*it : nullptr;
}

const KeyframeNode* Graph::find_keyframe(KeyframeId id) const {
  const auto it = lower_bound_by_id(keyframes_, id);
  return it != keyframes_.end() && it->id == id ? &*it : nullptr;
}

std::span<const KeyframeId> Graph::observers(LandmarkId id) const {
  const auto it = observers_.find(id);
  if (it == observers_.end()) return {};
  return it->second;
}

bool Graph::spans_a_plane(std::span<const LandmarkId> landmarks) const {
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Eigen::Vector3d& first = find_landmark(landmarks[i])->direction;
    for (const LandmarkId other : landmarks.subspan(i + 1)) {
      if (geometry::axial_angle(first, find_landmark(other)->direction) > kMinAngleBetweenDirections) return true;
    }
  }
  return false;
}

std::vector<Edge> Graph::sharing_keyframes(std::span<const LandmarkId> landmarks) const {
  std::map<KeyframeId, std::vector<LandmarkId>> shared;
  for (const LandmarkId id : landmarks) {
    for (const KeyframeId keyframe : observers(id)) shared[keyframe].push_back(id);
  }
  std::vector<Edge> sharing;
  for (const auto& [keyframe, ids] : shared) {
    if (ids.size() >= 2 && spans_a_plane(ids)) sharing.push_back({keyframe, {}, ids});
  }
  return sharing;
}

std::optional<KeyframeId> Graph::oldest_sharing_keyframe(std::span<const LandmarkId> landmarks) const {
  const std::vector<Edge> sharing = sharing_keyframes(landmarks);
  if (sharing.empty()) return std::nullopt;
  return sharing.front().first;
}

void Graph::remove_landmark(LandmarkId id) {
  const auto it = lower_bound_by_id(landmarks_, id);
  if (it == landmarks_.end() || it->id != id) return;
  landmarks_.erase(it);
  observers_.erase(id);
  std::erase_if(observations_, [id](const Observation& observation) { return observation.landmark == id; });
}

void Graph::put_landmark(const DirectionLandmark& landmark) {
  const auto it = lower_bound_by_id(landmarks_, landmark.id);
  if (it != landmarks_.end() && it->id == landmark.id) {
    *it = landmark;
  } else {
    landmarks_.insert(it, landmark);
  }
}

void Graph::put_observation(const Observation& observation) {
  observations_.push_back(observation);
  std::vector<KeyframeId>& keyframes = observers_[observation.landmark];
  if (keyframes.empty() || keyframes.back() != observation.keyframe) keyframes.push_back(observation.keyframe);
}

}  // namespace eg::egraph
