#include <array>
#include <cmath>
#include <numbers>

#include "common/base/random.hpp"
#include "common/synthetic/scene_builder.hpp"
#include "common/synthetic/scenes.hpp"

/// An attic studio: seven walls in seven directions, two of them leaning, no two at a right angle on purpose.
namespace eg::synthetic {
namespace {

struct Wall {
  double bearing_deg;  ///< direction from the middle to the wall
  double distance;     ///< metres, at height 1.3 m
  double lean_deg;     ///< positive: it leans over the room
  std::uint32_t colour;
};

constexpr std::array<Wall, 7> kWalls = {{{10, 2.9, 0, 0xd9c7a3},
                                         {62, 2.7, 32, 0xe6e0d4},
                                         {118, 2.8, 0, 0xb7c9b0},
                                         {163, 3.1, 0, 0xd8a48f},
                                         {214, 2.6, 24, 0xe6e0d4},
                                         {271, 2.8, 0, 0x9fb4c7},
                                         {325, 3.0, 8, 0xd9c7a3}}};

geometry::Plane leaning_plane(const Wall& wall) {
  const double bearing = wall.bearing_deg * std::numbers::pi / 180.0;
  const double lean = wall.lean_deg * std::numbers::pi / 180.0;
  const Eigen::Vector3d outwards(std::cos(bearing), std::sin(bearing), 0.0);
  const Eigen::Vector3d normal = -std::cos(lean) * outwards - std::sin(lean) * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d on_wall = wall.distance * outwards + 1.3 * Eigen::Vector3d::UnitZ();
  return {normal, -normal.dot(on_wall)};
}

std::uint32_t next_seed(base::Random& random) { return static_cast<std::uint32_t>(random.next() >> 32); }

void hang_picture(SceneBuilder& build, std::size_t wall, base::Random& random) {
  const Eigen::Vector2d middle = 0.5 * build.surface(wall).bounds().sizes();
  const Eigen::Vector2d size(random.uniform(0.6, 1.0), random.uniform(0.5, 0.8));
  const geometry::Pose at = mounted_at(build.surface(wall), middle.x() - 0.5 * size.x(), middle.y() - 0.5 * size.y());
  build.box(at, {0, -0.02, 0}, {size.x(), 0, size.y()}, kFront, picture(size.cast<float>(), 0.04F, next_seed(random)));
  build.moulding(at, size.x(), size.y(), 0.03, 0.035, {.colour = srgb(0x3a3029)}, true);
}

void furnish(SceneBuilder& build, base::Random& random) {
  const Material wood = {.texture = Texture::planks,
                         .colour = srgb(0xb98d5e),
                         .accent = srgb(0x8a6238),
                         .scale = 0.12F,
                         .seed = next_seed(random)};
  const Material blue = {.texture = Texture::tiles, .colour = srgb(0xe9e4d8), .accent = srgb(0x31708e), .scale = 0.15F};
  build.box(standing_at(1.9, -0.4, -1.2), {-0.5, -0.25, 0}, {0.5, 0.25, 0.6}, kStanding, wood);
  build.box(standing_at(-0.6, 1.9, 0.35), {-0.6, -0.2, 0}, {0.6, 0.2, 0.45}, kStanding, blue);
  build.box(standing_at(-2.1, 0.1, 1.1), {-0.3, -0.3, 0}, {0.3, 0.3, 0.7}, kStanding, wood);
  build.box(standing_at(-0.2, -2.0, -0.5), {-0.4, -0.25, 0}, {0.4, 0.25, 0.5}, kStanding, blue);
  build.box(standing_at(-0.2, -2.0, 0.2), {-0.15, -0.1, 0.5}, {0.15, 0.1, 0.72}, kStanding,
            picture({0.3F, 0.22F}, 0.0F, next_seed(random)));
}

}  // namespace

Scene make_slanted(std::uint64_t seed) {
  base::Random random(seed);
  std::vector<geometry::Plane> planes = {{Eigen::Vector3d::UnitZ(), 0.0}, {-Eigen::Vector3d::UnitZ(), 2.7}};
  std::vector<Material> materials = {{.texture = Texture::planks,
                                      .colour = srgb(0xc79a6b),
                                      .accent = srgb(0x8f6238),
                                      .scale = 0.16F,
                                      .seed = next_seed(random)},
                                     {.colour = srgb(0xf4f1ea)}};
  for (const Wall& wall : kWalls) {
    planes.push_back(leaning_plane(wall));
    const Colour colour = srgb(wall.colour);
    materials.push_back({.texture = Texture::noise,
                         .colour = colour,
                         .accent = 0.85F * colour,
                         .scale = 0.3F,
                         .seed = next_seed(random)});
  }
  SceneBuilder build;
  const std::size_t first_wall = build.interior(planes, materials) + 2;
  for (std::size_t i = 0; i < kWalls.size(); ++i) {
    hang_picture(build, first_wall + i, random);
    build.skirting(first_wall + i, 0.08, 0.018, {.colour = srgb(0xfaf8f2)});
  }
  furnish(build, random);
  build.lamp({{0.3, 0.0, 2.65}, 0.4, 1.6F});
  return build.take();
}

}  // namespace eg::synthetic
