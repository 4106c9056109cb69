#include "common/tracking/map_correction.hpp"

#include <optional>

namespace eg::tracking {
namespace {

using geometry::Pose;

bool equal(const Pose& a, const Pose& b) { return a.rotation == b.rotation && a.translation == b.translation; }

/// How the keyframes of a map move in the world, by id; none: not at all.
class Motions {
 public:
  Motions(std::span<const egraph::CorrectedPose> keyframes, const Map& map) : of_keyframe_(map.keyframes().size()) {
    for (const egraph::CorrectedPose& moved : keyframes) {
      of_keyframe_[static_cast<std::size_t>(moved.keyframe.value)] =
          moved.world_from_camera * map.keyframe(moved.keyframe).world_from_camera.inverse();
    }
  }

  [[nodiscard]] bool any(std::span<const Observer> observers) const {
    for (const Observer& observer : observers) {
      if (of(observer)) return true;
    }
    return false;
  }

  /// The mean of what `move`, given each observer's motion, returns.
  template <typename Move>
  [[nodiscard]] auto mean(std::span<const Observer> observers, const Move& move) const {
    auto sum = move(of(observers.front()).value_or(Pose{}));
    for (const Observer& observer : observers.subspan(1)) sum += move(of(observer).value_or(Pose{}));
    return (sum / static_cast<double>(observers.size())).eval();
  }

 private:
  [[nodiscard]] const std::optional<Pose>& of(const Observer& observer) const {
    return of_keyframe_[static_cast<std::size_t>(observer.keyframe.value)];
  }

  std::vector<std::optional<Pose>> of_keyframe_;
};

Eigen::Vector4d coefficients(const geometry::Plane& plane) {
  return {plane.normal.x(), plane.normal.y(), plane.normal.z(), plane.distance};
}

void move_features(const Motions& motions, Map& map) {
  for (const MapPoint& point : map.points()) {
    const auto observers = map.observers(point.id);
    if (!motions.any(observers)) continue;
    map.move_point(point.id,
                   motions.mean(observers, [&](const Pose& m) -> Eigen::Vector3d { return m * point.position; }));
  }
  for (const MapLine& line : map.lines()) {
    const auto observers = map.observers(line.id);
    if (!motions.any(observers)) continue;
    map.move_line(line.id, motions.mean(observers, [&](const Pose& m) -> Eigen::Vector3d { return m * line.start; }),
                  motions.mean(observers, [&](const Pose& m) -> Eigen::Vector3d { return m * line.end; }));
  }
  for (const MapPlane& plane : map.planes()) {
    const auto observers = map.observers(plane.id);
    if (!motions.any(observers)) continue;
    const Eigen::Vector4d mean = motions.mean(
        observers, [&](const Pose& m) { return coefficients(geometry::transform(m, plane.estimate.plane)); });
    map.move_plane(plane.id, {mean.head<3>().normalized(), mean[3]});
  }
}

}  // namespace

std::vector<egraph::CorrectedPose> corrected_poses(const Map& map, std::span<const KeyframeCorrection> corrections,
                                                   KeyframeId newest) {
  std::vector<egraph::CorrectedPose> poses;
  std::optional<Pose> last_motion;
  for (const KeyframeCorrection& correction : corrections) {
    const Pose& current = map.keyframe(correction.keyframe).world_from_camera;
    // Exactly the refined pose where nothing happened meanwhile, so that tracker and server agree to the last bit.
    const Pose motion = correction.refined * correction.announced.inverse();
    poses.push_back(
        {correction.keyframe, equal(current, correction.announced) ? correction.refined : motion * current});
    if (correction.keyframe == newest) last_motion = motion;
  }
  if (!last_motion) return poses;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    if (keyframe.id > newest) poses.push_back({keyframe.id, *last_motion * keyframe.world_from_camera});
  }
  return poses;
}

void move_with_keyframes(std::span<const egraph::CorrectedPose> keyframes, Map& map) {
  move_features(Motions(keyframes, map), map);
  for (const egraph::CorrectedPose& moved : keyframes) map.move_keyframe(moved.keyframe, moved.world_from_camera);
}

}  // namespace eg::tracking
