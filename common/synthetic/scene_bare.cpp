#include <array>
#include <numbers>

#include "common/synthetic/scene_builder.hpp"
#include "common/synthetic/scenes.hpp"

/// The scenes with next to no texture.
namespace eg::synthetic {
namespace {

Material white(float grain) { return {.colour = srgb(0xf0efec), .grain = grain}; }

}  // namespace

/// 14 x 2 x 2.5 m: only skirting boards, doors of the walls' colour, and lamps.
Scene make_corridor(std::uint64_t seed) {
  constexpr double kHalfLength = 7.0;
  constexpr double kHalfWidth = 1.0;
  constexpr double kHeight = 2.5;
  const std::array<geometry::Plane, 6> planes = {{{Eigen::Vector3d::UnitZ(), 0.0},
                                                  {-Eigen::Vector3d::UnitZ(), kHeight},
                                                  {-Eigen::Vector3d::UnitX(), kHalfLength},
                                                  {Eigen::Vector3d::UnitX(), kHalfLength},
                                                  {-Eigen::Vector3d::UnitY(), kHalfWidth},
                                                  {Eigen::Vector3d::UnitY(), kHalfWidth}}};
  Material wall = white(0.012F);
  wall.seed = static_cast<std::uint32_t>(seed);
  Material ground = wall;
  ground.colour = srgb(0xc9c7c2);
  const std::array<Material, 6> materials = {ground, wall, wall, wall, wall, wall};
  SceneBuilder build;
  const std::size_t first = build.interior(planes, materials);
  const Material trim = {.colour = srgb(0xb9bcc0), .grain = 0.02F};
  for (std::size_t i = 2; i < 6; ++i) build.skirting(first + i, 0.1, 0.015, trim);
  // Doors at uneven distances, so that no two places look the same.
  const std::array<std::array<double, 3>, 2> doors = {{{2.1, 6.4, 11.3}, {1.2, 5.1, 8.7}}};
  for (std::size_t side = 0; side < 2; ++side) {
    for (const double u : doors[side]) {
      const geometry::Pose at = mounted_at(build.surface(first + 4 + side), u, 0.0);
      build.box(at, {0, -0.02, 0}, {0.9, 0, 2.05}, kFront, wall);
      build.moulding(at, 0.9, 2.05, 0.08, 0.035, trim, false);
    }
  }
  for (const double x : {-5.5, -2.0, 1.5, 5.0}) {
    build.box(standing_at(x, 0, 0), {-0.3, -0.15, kHeight - 0.04}, {0.3, 0.15, kHeight}, kAllFaces & ~kTop,
              {.colour = srgb(0xffffff), .grain = 0.0F, .glow = 0.8F});
    build.lamp({{x, 0, kHeight - 0.05}, 0.2, 0.45F});
  }
  return build.take();
}

/// Floor and two walls that meet at (1.8, 1.8, 0), each 4.5 m wide; the other sides are open.
Scene make_corner(std::uint64_t seed) {
  constexpr double kCorner = 1.8;
  constexpr double kSize = 4.5;
  Material wall = white(0.0F);
  wall.seed = static_cast<std::uint32_t>(seed);
  SceneBuilder build;
  geometry::Pose world_from_corner{geometry::Pose{}.rotation, {kCorner, kCorner, 0.0}};
  build.box(world_from_corner, {-kSize, -kSize, -0.1}, {0, 0, 0}, kTop, wall);
  build.box(world_from_corner, {0, -kSize, 0}, {0.1, 0, kSize}, kLeft, wall);
  build.box(world_from_corner, {-kSize, 0, 0}, {0, 0.1, kSize}, kFront, wall);
  build.lamp({{-0.5, 0.2, 4.0}, 0.3, 2.2F});
  return build.take();
}

}  // namespace eg::synthetic
