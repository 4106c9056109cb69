#include <array>
#include <cmath>
#include <numbers>

#include "common/base/random.hpp"
#include "common/synthetic/material.hpp"

namespace eg::synthetic {
namespace {

using Palette = std::array<std::uint32_t, 6>;

/// Each: the ground, then the figures' colours.
constexpr std::array<Palette, 4> kPalettes = {{
    {0xf1e3c8, 0x264653, 0x2a9d8f, 0xe9c46a, 0xf4a261, 0xe76f51},
    {0xdfe7e8, 0x1d3557, 0x457b9d, 0xa8dadc, 0xe63946, 0xf6bd60},
    {0x2b2d42, 0xef233c, 0xedf2f4, 0xf2b134, 0x8d99ae, 0x4f9d69},
    {0xf7ede2, 0x84a59d, 0xf28482, 0x3d405b, 0xf6bd60, 0x5f7a61},
}};

Eigen::Vector2f random_point(base::Random& random, const Eigen::Vector2f& extent) {
  const auto u = static_cast<float>(random.uniform());
  const auto v = static_cast<float>(random.uniform());
  return {u * extent.x(), v * extent.y()};
}

Eigen::Vector2f unit_vector(double angle) {
  return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
}

Shape random_shape(base::Random& random, const Palette& palette, const Eigen::Vector2f& extent, float shrink) {
  const float unit = shrink * extent.minCoeff();
  Shape shape;
  shape.centre = random_point(random, extent);
  shape.half_size.x() = unit * static_cast<float>(random.uniform(0.12, 0.3));
  shape.half_size.y() = unit * static_cast<float>(random.uniform(0.08, 0.3));
  // Mostly upright figures, some turned: edges in the main directions and corners at all angles.
  if (random.uniform() > 0.6) shape.axis = unit_vector(random.uniform(0.0, std::numbers::pi));
  shape.disc = random.uniform() < 0.3;
  shape.colour = srgb(palette[static_cast<std::size_t>(1 + random.index(5))]);
  return shape;
}

}  // namespace

Material picture(const Eigen::Vector2f& extent, float border, std::uint32_t seed) {
  base::Random random(seed);
  const Palette& palette = kPalettes[static_cast<std::size_t>(random.index(static_cast<int>(kPalettes.size())))];
  Material material;
  material.texture = Texture::shapes;
  material.colour = srgb(palette[0]);
  material.accent = srgb(0xf8f6f0);
  material.extent = extent;
  material.border = border;
  material.seed = seed;
  constexpr int kFigures = 18;
  for (int i = 0; i < kFigures; ++i) {
    // From large to small, so that the late ones do not hide the early ones.
    const float shrink = 1.3F - 0.9F * static_cast<float>(i) / kFigures;
    material.shapes.push_back(random_shape(random, palette, extent, shrink));
  }
  return material;
}

Material rug(const Eigen::Vector2f& extent, std::uint32_t seed) {
  base::Random random(seed);
  Material material;
  material.texture = Texture::shapes;
  material.colour = srgb(0x9c4a3c);
  material.accent = srgb(0x2f4858);
  material.extent = extent;
  material.border = 0.08F;
  material.grain = 0.25F;
  material.seed = seed;
  const std::array<Colour, 4> colours = {srgb(0xe8d8b8), srgb(0x2f4858), srgb(0xd9a441), srgb(0x6b8f71)};
  constexpr float kPitch = 0.4F;
  const auto columns = static_cast<int>((extent.x() - 0.2F) / kPitch);
  const auto rows = static_cast<int>((extent.y() - 0.2F) / kPitch);
  const Eigen::Vector2f first = 0.5F * (extent - kPitch * Eigen::Vector2f(columns - 1, rows - 1));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector2f centre = first + kPitch * Eigen::Vector2f(column, row);
      const auto colour = static_cast<std::size_t>(random.index(4));
      const Eigen::Vector2f diagonal = unit_vector(0.25 * std::numbers::pi);
      material.shapes.push_back({centre, Eigen::Vector2f::Constant(0.11F), diagonal, false, colours[colour]});
      material.shapes.push_back({centre, Eigen::Vector2f::Constant(0.05F), diagonal, false, colours[(colour + 1) % 4]});
    }
  }
  return material;
}

}  // namespace eg::synthetic
