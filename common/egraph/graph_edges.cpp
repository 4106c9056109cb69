#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "common/egraph/graph.hpp"
#include "common/egraph/rotation_solver.hpp"
#include "common/geometry/so3.hpp"

/// The implicit edges of the graph.
namespace eg::egraph {
namespace {

/// The first keyframe in both lists (oldest first) that is older than `limit`. It leaps over what only one list has.
std::optional<KeyframeId> first_common(std::span<const KeyframeId> a, std::span<const KeyframeId> b, KeyframeId limit) {
  auto i = a.begin();
  auto j = b.begin();
  while (i != a.end() && j != b.end() && std::max(*i, *j) < limit) {
    if (*i == *j) return *i;
    if (*i < *j) {
      i = std::lower_bound(i, a.end(), *j);
    } else {
      j = std::lower_bound(j, b.end(), *i);
    }
  }
  return std::nullopt;
}

}  // namespace

bool Graph::parallel(LandmarkId a, LandmarkId b) const {
  const DirectionLandmark* first = find_landmark(a);
  const DirectionLandmark* second = find_landmark(b);
  if (first == nullptr || second == nullptr) return true;
  return geometry::axial_angle(first->direction, second->direction) <= kMinAngleBetweenDirections;
}

bool Graph::spans_a_plane(std::span<const LandmarkId> landmarks) const {
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    for (std::size_t j = i + 1; j < landmarks.size(); ++j) {
      if (!parallel(landmarks[i], landmarks[j])) return true;
    }
  }
  return false;
}

std::vector<Edge> Graph::sharing_keyframes(std::span<const LandmarkId> landmarks, KeyframeId younger,
                                           std::size_t max_observers) const {
  std::vector<std::pair<KeyframeId, LandmarkId>> views;
  for (const LandmarkId landmark : landmarks) {
    const std::span<const KeyframeId> all = observers(landmark);
    for (const KeyframeId keyframe : all.first(std::min(all.size(), max_observers))) {
      if (younger.valid() && keyframe >= younger) break;
      views.emplace_back(keyframe, landmark);
    }
  }
  std::stable_sort(views.begin(), views.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Edge> sharing;
  std::vector<LandmarkId> shared;
  for (std::size_t i = 0; i < views.size();) {
    const KeyframeId keyframe = views[i].first;
    shared.clear();
    for (; i < views.size() && views[i].first == keyframe; ++i) shared.push_back(views[i].second);
    if (spans_a_plane(shared)) sharing.push_back({keyframe, younger, shared});
  }
  return sharing;
}

std::optional<KeyframeId> Graph::oldest_sharing_keyframe(std::span<const LandmarkId> landmarks) const {
  std::optional<KeyframeId> oldest;
  KeyframeId limit{INT32_MAX};
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    for (std::size_t j = i + 1; j < landmarks.size(); ++j) {
      const auto common = first_common(observers(landmarks[i]), observers(landmarks[j]), limit);
      if (!common || parallel(landmarks[i], landmarks[j])) continue;
      oldest = limit = *common;
    }
  }
  return oldest;
}

std::vector<Edge> Graph::edges_to_older(KeyframeId id, std::size_t max_observers) const {
  std::set<LandmarkId> seen;
  for (const Observation& observation : observations(id)) seen.insert(observation.landmark);
  return sharing_keyframes(std::vector<LandmarkId>(seen.begin(), seen.end()), id, max_observers);
}

std::vector<Edge> Graph::edges(std::size_t max_observers) const {
  std::vector<Edge> all;
  for (const KeyframeNode& keyframe : keyframes_) {
    std::vector<Edge> older = edges_to_older(keyframe.id, max_observers);
    all.insert(all.end(), std::make_move_iterator(older.begin()), std::make_move_iterator(older.end()));
  }
  return all;
}

}  // namespace eg::egraph
