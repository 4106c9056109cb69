#include "common/tracking/local_window.hpp"

#include <algorithm>

namespace eg::tracking {
namespace {

constexpr KeyframeId kWorld{0};

template <typename Id>
void sort_and_make_unique(std::vector<Id>& ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

/// The ids of matches whose landmark lives and was seen at least twice.
template <typename Matches, typename Ids, typename Observers>
void collect(const Matches& matches, const Observers& observers, Ids& ids) {
  for (const auto& match : matches) {
    if (observers(match.id).size() >= 2) ids.push_back(match.id);
  }
}

}  // namespace

bool LocalWindow::contains(KeyframeId id) const { return std::binary_search(keyframes.begin(), keyframes.end(), id); }

LocalWindow local_window(const Map& map, KeyframeId newest, int size) {
  LocalWindow window;
  window.keyframes.push_back(newest);
  for (const egraph::Covisibility& other : map.covisible(newest)) {
    if (static_cast<int>(window.keyframes.size()) >= size) break;
    window.keyframes.push_back(other.keyframe);
  }
  std::erase(window.keyframes, kWorld);
  std::sort(window.keyframes.begin(), window.keyframes.end());
  for (const KeyframeId id : window.keyframes) {
    const Matches& matches = map.keyframe(id).matches;
    collect(
        matches.points, [&](PointId point) { return map.observers(point); }, window.points);
    collect(
        matches.lines, [&](LineId line) { return map.observers(line); }, window.lines);
    collect(
        matches.planes, [&](PlaneId plane) { return map.observers(plane); }, window.planes);
  }
  std::erase_if(window.points, [&](PointId id) { return !map.point(id).alive; });
  std::erase_if(window.lines, [&](LineId id) { return !map.line(id).alive; });
  sort_and_make_unique(window.points);
  sort_and_make_unique(window.lines);
  sort_and_make_unique(window.planes);
  return window;
}

}  // namespace eg::tracking
