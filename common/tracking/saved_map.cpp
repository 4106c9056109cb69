#include "common/tracking/saved_map.hpp"

#include <algorithm>
#include <string>

namespace eg::tracking {
namespace {

template <typename MapId>
bool is_same(const std::vector<Match<MapId>>& a, const std::vector<Match<MapId>>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Match<MapId>& x, const Match<MapId>& y) {
    return x.feature == y.feature && x.id == y.id;
  });
}

/// The matches with landmarks that are there already; the others made theirs.
template <typename MapId>
std::vector<Match<MapId>> only_known(const std::vector<Match<MapId>>& matches, std::size_t known) {
  std::vector<Match<MapId>> kept;
  std::copy_if(matches.begin(), matches.end(), std::back_inserter(kept), [&](const Match<MapId>& match) {
    return match.id.valid() && static_cast<std::size_t>(match.id.value) < known;
  });
  return kept;
}

/// Whether each match names a feature that there is, and none twice.
template <typename MapId>
bool are_of_features(const std::vector<Match<MapId>>& matches, std::size_t features) {
  std::vector<bool> used(features, false);
  for (const Match<MapId>& match : matches) {
    if (match.feature < 0 || static_cast<std::size_t>(match.feature) >= features) return false;
    if (used[static_cast<std::size_t>(match.feature)]) return false;
    used[static_cast<std::size_t>(match.feature)] = true;
  }
  return true;
}

bool add(const SavedMap::Keyframe& keyframe, Map& map) {
  const features::FrameFeatures& features = keyframe.features;
  const Matches& matches = keyframe.links.matches;
  if (!are_of_features(matches.points, features.points.size()) ||
      !are_of_features(matches.lines, features.lines.size()) ||
      !are_of_features(matches.planes, features.planes.size())) {
    return false;
  }
  const bool directions_are_there = std::all_of(
      keyframe.links.directions.begin(), keyframe.links.directions.end(),
      [&](const egraph::Association& association) { return association.feature < features.directions.size(); });
  if (!directions_are_there) return false;
  map.add_keyframe(features, keyframe.links.world_from_camera,
                   {only_known(matches.points, map.points().size()), only_known(matches.lines, map.lines().size()),
                    only_known(matches.planes, map.planes().size())},
                   keyframe.links.directions);
  const Matches& made = map.keyframes().back().matches;
  return is_same(made.points, matches.points) && is_same(made.lines, matches.lines) &&
         is_same(made.planes, matches.planes);
}

void move_landmarks(const LandmarkPositions& positions, Map& map) {
  for (const MapPoint& point : map.points()) {
    const auto& [position, alive] = positions.points[static_cast<std::size_t>(point.id.value)];
    map.move_point(point.id, position);
    if (!alive) map.cull(point.id);
  }
  for (const MapLine& line : map.lines()) {
    const auto& [start, end, alive] = positions.lines[static_cast<std::size_t>(line.id.value)];
    map.move_line(line.id, start, end);
    if (!alive) map.cull(line.id);
  }
  for (const MapPlane& plane : map.planes()) {
    map.move_plane(plane.id, positions.planes[static_cast<std::size_t>(plane.id.value)]);
  }
}

}  // namespace

KeyframeLinks links_of(const MapKeyframe& keyframe) {
  return {keyframe.world_from_camera, keyframe.matches, keyframe.directions};
}

LandmarkPositions positions_of(const Map& map) {
  LandmarkPositions positions;
  for (const MapPoint& point : map.points()) positions.points.push_back({point.position, point.alive});
  for (const MapLine& line : map.lines()) positions.lines.push_back({line.start, line.end, line.alive});
  for (const MapPlane& plane : map.planes()) positions.planes.push_back(plane.estimate.plane);
  return positions;
}

base::Result<Map> rebuild(const SavedMap& saved) {
  Map map;
  for (std::size_t i = 0; i < saved.keyframes.size(); ++i) {
    if (!add(saved.keyframes[i], map)) {
      return base::fail("keyframe " + std::to_string(i) + ": its matches contradict its features or earlier keyframes");
    }
  }
  const LandmarkPositions& landmarks = saved.landmarks;
  if (landmarks.points.size() != map.points().size() || landmarks.lines.size() != map.lines().size() ||
      landmarks.planes.size() != map.planes().size()) {
    return base::fail("there are other landmarks than the keyframes saw");
  }
  move_landmarks(landmarks, map);
  return map;
}

}  // namespace eg::tracking
