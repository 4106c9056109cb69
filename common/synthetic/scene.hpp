#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/synthetic/surface.hpp"

namespace eg::synthetic {

/// A lamp: a horizontal square that shines downwards.
struct Lamp {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< world, metres
  double half_size = 0.3;                            ///< metres
  float power = 1.0F;
};

/// An indoor scene with exact geometry. The world's z axis points up, the floor is z = 0, and around (0, 0, 1.3) there
/// is free space.
struct Scene {
  std::string name;
  std::vector<Surface> surfaces;
  std::vector<Lamp> lamps;
  float ambient = 0.45F;  ///< light from all sides, before occlusion
};

/// The names make_scene() knows:
/// `room` (furnished and textured), `slanted` (an attic of seven wall directions), `corridor` (white, with door frames
/// and skirting boards only), `corner` (three white planes and nothing else).
std::vector<std::string> scene_names();

/// Builds a scene. The seed varies its pictures and textures, never its geometry. Fails on an unknown name.
base::Result<Scene> make_scene(std::string_view name, std::uint64_t seed);

/// Where a ray meets the scene first.
struct Hit {
  double distance = 0.0;  ///< in lengths of the direction vector
  int surface = -1;       ///< index into Scene::surfaces
};

/// The first surface that the ray meets within (0, `max_distance`), from its front. Plain search through all surfaces.
std::optional<Hit> cast_ray(const Scene& scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                            double max_distance);

/// The distance in metres from a point to the nearest surface.
double clearance(const Scene& scene, const Eigen::Vector3d& point);

}  // namespace eg::synthetic
