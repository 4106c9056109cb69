#include "common/synthetic/scene.hpp"

#include <algorithm>
#include <limits>

#include "common/synthetic/scenes.hpp"

namespace eg::synthetic {
namespace {

struct NamedScene {
  const char* name;
  Scene (*make)(std::uint64_t seed);
};

constexpr NamedScene kScenes[] = {
    {"room", make_room}, {"slanted", make_slanted}, {"corridor", make_corridor}, {"corner", make_corner}};

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d side = b - a;
  const double along = std::clamp(side.dot(p - a) / side.squaredNorm(), 0.0, 1.0);
  return (p - a - along * side).norm();
}

double distance_to(const Surface& surface, const Eigen::Vector3d& point) {
  const double height = surface.plane().signed_distance(point);
  const Eigen::Vector2d uv = surface.uv(point);
  if (surface.contains(uv)) return std::abs(height);
  double aside = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < surface.outline.size(); ++i) {
    const auto& next = surface.outline[(i + 1) % surface.outline.size()];
    aside = std::min(aside, distance_to_segment(uv, surface.outline[i], next));
  }
  return std::hypot(height, aside);
}

}  // namespace

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const NamedScene& scene : kScenes) names.emplace_back(scene.name);
  return names;
}

base::Result<Scene> make_scene(std::string_view name, std::uint64_t seed) {
  const auto* it = std::find_if(std::begin(kScenes), std::end(kScenes), [&](const auto& s) { return name == s.name; });
  if (it != std::end(kScenes)) {
    Scene scene = it->make(seed);
    scene.name = it->name;
    return scene;
  }
  std::string known;
  for (const NamedScene& scene : kScenes) known += (known.empty() ? "" : ", ") + std::string(scene.name);
  return base::fail("unknown synthetic scene '" + std::string(name) + "' (known: " + known + ")");
}

std::optional<Hit> cast_ray(const Scene& scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                            double max_distance) {
  std::optional<Hit> nearest;
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
    const Surface& surface = scene.surfaces[i];
    const geometry::Plane plane = surface.plane();
    const double approach = -plane.normal.dot(direction);
    const double height = plane.signed_distance(origin);
    if (approach <= 0.0 || height <= 0.0) continue;
    const double distance = height / approach;
    if (distance >= (nearest ? nearest->distance : max_distance)) continue;
    if (surface.contains(surface.uv(origin + distance * direction))) nearest = Hit{distance, static_cast<int>(i)};
  }
  return nearest;
}

double clearance(const Scene& scene, const Eigen::Vector3d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Surface& surface : scene.surfaces) nearest = std::min(nearest, distance_to(surface, point));
  return nearest;
}

}  // namespace eg::synthetic
