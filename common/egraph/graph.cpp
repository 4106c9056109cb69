#include "common/egraph/graph.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "common/base/check.hpp"

namespace eg::egraph {
namespace {

template <typename Node, typename Id>
auto lower_bound_by_id(Node& nodes, Id id) {
  return std::lower_bound(nodes.begin(), nodes.end(), id, [](const auto& node, Id value) { return node.id < value; });
}

template <typename Node, typename Id>
auto find_by_id(Node& nodes, Id id) -> decltype(&*nodes.begin()) {
  const auto it = lower_bound_by_id(nodes, id);
  return it != nodes.end() && it->id == id ? &*it : nullptr;
}

struct ByKeyframe {
  bool operator()(const Observation& a, KeyframeId b) const { return a.keyframe < b; }
  bool operator()(KeyframeId a, const Observation& b) const { return a < b.keyframe; }
};

base::Status unknown_landmark(LandmarkId id) {
  return base::fail("graph holds an observation of landmark " + std::to_string(id.value) + ", which does not exist");
}

base::Status unknown_keyframe(const char* what, KeyframeId id) {
  return base::fail(std::string("graph holds ") + what + " of keyframe " + std::to_string(id.value) +
                    ", which does not exist");
}

}  // namespace

base::Status Graph::check(const GraphUpdate& update) const {
  if (update.base_version != version_) {
    return base::fail("graph update starts at version " + std::to_string(update.base_version) + ", the graph is at " +
                      std::to_string(version_));
  }
  if (!keyframes_.empty() && update.keyframe.id <= keyframes_.back().id) {
    return base::fail("graph update brings keyframe " + std::to_string(update.keyframe.id.value) + " a second time");
  }
  for (const Observation& observation : update.observations) {
    const auto is_observed = [&](const DirectionLandmark& landmark) { return landmark.id == observation.landmark; };
    if (observation.keyframe != update.keyframe.id) return unknown_keyframe("an observation", observation.keyframe);
    if (find_landmark(observation.landmark) == nullptr &&
        std::none_of(update.landmarks.begin(), update.landmarks.end(), is_observed)) {
      return unknown_landmark(observation.landmark);
    }
  }
  const auto known = [&](KeyframeId id) { return id == update.keyframe.id || find_keyframe(id) != nullptr; };
  for (const RelativePose& relative : update.relative_poses) {
    for (const KeyframeId id : {relative.first, relative.second}) {
      if (!known(id)) return unknown_keyframe("a relative pose", id);
    }
  }
  for (const auto* list : {&update.moved, &update.corrections}) {
    for (const CorrectedPose& corrected : *list) {
      if (!known(corrected.keyframe)) return unknown_keyframe("a correction", corrected.keyframe);
    }
  }
  return {};
}

base::Status Graph::apply(const GraphUpdate& update) {
  if (update.version <= version_) return {};
  if (const base::Status sound = check(update); !sound) return sound;
  version_ = update.version;
  keyframes_.push_back(update.keyframe);
  for (const DirectionLandmark& landmark : update.landmarks) put_landmark(landmark);
  for (const Observation& observation : update.observations) put_observation(observation);
  for (const LandmarkId id : update.removed) remove_landmark(id);
  for (const Covisibility& covisible : update.covisible) {
    covisibility_.push_back({covisible.keyframe, update.keyframe.id, covisible.shared_features});
  }
  for (const RelativePose& relative : update.relative_poses) put_relative_pose(relative);
  refine(update.moved, {});
  for (const CorrectedPose& moved : update.moved) measure_again(moved.keyframe);
  refine(update.corrections, {});
  return {};
}

base::Status Graph::reset(const GraphSnapshot& snapshot) {
  Graph graph;
  graph.version_ = snapshot.version;
  graph.keyframes_ = snapshot.keyframes;
  graph.covisibility_ = snapshot.covisibility;
  std::sort(graph.keyframes_.begin(), graph.keyframes_.end(),
            [](const KeyframeNode& a, const KeyframeNode& b) { return a.id < b.id; });
  for (const DirectionLandmark& landmark : snapshot.landmarks) graph.put_landmark(landmark);
  graph.next_landmark_ = std::max(graph.next_landmark_, snapshot.next_landmark);
  std::vector<Observation> observations = snapshot.observations;
  std::stable_sort(observations.begin(), observations.end(),
                   [](const Observation& a, const Observation& b) { return a.keyframe < b.keyframe; });
  for (const Observation& observation : observations) {
    if (graph.find_landmark(observation.landmark) == nullptr) return unknown_landmark(observation.landmark);
    if (graph.find_keyframe(observation.keyframe) == nullptr) {
      return unknown_keyframe("an observation", observation.keyframe);
    }
    graph.put_observation(observation);
  }
  for (const RelativePose& relative : snapshot.relative_poses) {
    for (const KeyframeId id : {relative.first, relative.second}) {
      if (graph.find_keyframe(id) == nullptr) return unknown_keyframe("a relative pose", id);
    }
    graph.put_relative_pose(relative);
  }
  *this = std::move(graph);
  return {};
}

GraphSnapshot Graph::snapshot(std::int64_t session) const {
  GraphSnapshot snapshot;
  snapshot.session = session;
  snapshot.version = version_;
  snapshot.next_landmark = next_landmark_;
  snapshot.keyframes = keyframes_;
  snapshot.landmarks = landmarks_;
  snapshot.observations = observations_;
  snapshot.covisibility = covisibility_;
  snapshot.relative_poses = relative_poses_;
  return snapshot;
}

const DirectionLandmark* Graph::find_landmark(LandmarkId id) const { return find_by_id(landmarks_, id); }

const KeyframeNode* Graph::find_keyframe(KeyframeId id) const { return find_by_id(keyframes_, id); }

std::vector<const DirectionLandmark*> Graph::landmarks_near(const Eigen::Vector3d& direction, double max_angle) const {
  std::vector<const DirectionLandmark*> found;
  for (const LandmarkId id : index_.near(direction, max_angle)) found.push_back(find_landmark(id));
  return found;
}

std::span<const KeyframeId> Graph::observers(LandmarkId id) const {
  const auto it = observers_.find(id);
  if (it == observers_.end()) return {};
  return it->second;
}

std::span<const Observation> Graph::observations(KeyframeId id) const {
  const auto [first, last] = std::equal_range(observations_.begin(), observations_.end(), id, ByKeyframe());
  return {first, last};
}

void Graph::remove_landmark(LandmarkId id) {
  const auto it = lower_bound_by_id(landmarks_, id);
  if (it == landmarks_.end() || it->id != id) return;
  for (const KeyframeId observer : observers(id)) {
    const auto [first, last] = std::equal_range(observations_.begin(), observations_.end(), observer, ByKeyframe());
    const auto of_landmark = [id](const Observation& observation) { return observation.landmark == id; };
    observations_.erase(std::remove_if(first, last, of_landmark), last);
  }
  index_.erase(id, it->direction);
  potential_directions_.erase(id);
  observers_.erase(id);
  landmarks_.erase(it);
}

void Graph::put_landmark(const DirectionLandmark& landmark) {
  const auto it = lower_bound_by_id(landmarks_, landmark.id);
  if (it != landmarks_.end() && it->id == landmark.id) {
    index_.erase(it->id, it->direction);
    *it = landmark;
  } else {
    landmarks_.insert(it, landmark);
  }
  index_.insert(landmark.id, landmark.direction);
  if (landmark.kind == DirectionKind::potential_direction) {
    potential_directions_.insert(landmark.id);
  } else {
    potential_directions_.erase(landmark.id);
  }
  next_landmark_.value = std::max(next_landmark_.value, landmark.id.value + 1);
}

void Graph::put_observation(const Observation& observation) {
  observations_.push_back(observation);
  std::vector<KeyframeId>& keyframes = observers_[observation.landmark];
  if (keyframes.empty() || keyframes.back() != observation.keyframe) keyframes.push_back(observation.keyframe);
}

void Graph::refine(std::span<const CorrectedPose> keyframes, std::span<const DirectionLandmark> landmarks) {
  for (const CorrectedPose& moved : keyframes) {
    KeyframeNode* node = find_by_id(keyframes_, moved.keyframe);
    EG_CHECK(node != nullptr, "only keyframes of the graph are refined");
    node->world_from_camera = moved.world_from_camera;
  }
  for (const DirectionLandmark& moved : landmarks) put_landmark(moved);
}

}  // namespace eg::egraph
