#include "common/synthetic/material.hpp"

#include <array>
#include <cmath>

#include "common/synthetic/value_noise.hpp"

namespace eg::synthetic {
namespace {

/// How much of a pixel lies on the positive side of an edge at signed distance `d` from the pixel's centre.
float coverage(float d, float footprint) { return std::clamp(d / footprint + 0.5F, 0.0F, 1.0F); }

Colour mix(const Colour& a, const Colour& b, float share_of_b) { return a + share_of_b * (b - a); }

/// Distance from `x` to the nearest multiple of `period`.
float distance_to_multiple(float x, float period) {
  return std::abs(x - period * static_cast<float>(floor_to_int(x / period + 0.5F)));
}

int cell_index(float x, float size) { return floor_to_int(x / size); }

/// Share of joint of width `width` at distance `d` from its middle. A joint finer than the pixel dims, it does not
/// widen.
float joint(float d, float width, float footprint) {
  const float blur = std::max(footprint, 0.002F);
  return std::clamp((0.5F * width - d) / blur + 0.5F, 0.0F, 1.0F) * std::min(1.0F, width / blur);
}

Colour tiles(const Material& m, const Eigen::Vector2f& uv, float footprint) {
  const int column = cell_index(uv.x(), m.scale);
  const int row = cell_index(uv.y(), m.scale);
  const float shade = 1.0F + 0.12F * (unit_hash(column, row, m.seed) - 0.5F);
  const float d = std::min(distance_to_multiple(uv.x(), m.scale), distance_to_multiple(uv.y(), m.scale));
  // Across a joint neighbouring tiles mix half and half, so that the edge is as smooth as the pixel is wide.
  const float own = 0.5F + 0.5F * std::min(1.0F, 2.0F * d / footprint);
  const bool odd = ((column + row) & 1) != 0;
  const Colour tile = mix(odd ? m.accent : m.colour, odd ? m.colour : m.accent, 1.0F - own);
  return mix(shade * tile, Colour(0.4F * (m.colour + m.accent)), joint(d, 0.02F * m.scale + 0.003F, footprint));
}

Colour bricks(const Material& m, const Eigen::Vector2f& uv, float footprint) {
  const int row = cell_index(uv.y(), m.scale);
  const float length = 3.0F * m.scale;
  const float shifted = uv.x() + ((row & 1) != 0 ? 0.5F * length : 0.0F);
  const int column = cell_index(shifted, length);
  const float shade = 0.72F + 0.5F * unit_hash(column, row, m.seed);
  const float warm = unit_hash(column, row, m.seed + 1) - 0.5F;
  const Colour brick = shade * m.colour.cwiseProduct(Colour(1.0F + 0.15F * warm, 1.0F, 1.0F - 0.15F * warm));
  const float d = std::min(distance_to_multiple(uv.y(), m.scale), distance_to_multiple(shifted, length));
  return mix(brick, m.accent, joint(d, 0.16F * m.scale, footprint));
}

Colour planks(const Material& m, const Eigen::Vector2f& uv, float footprint) {
  const int row = cell_index(uv.y(), m.scale);
  const float length = 12.0F * m.scale;
  const float shifted = uv.x() + length * unit_hash(row, 17, m.seed);
  const int column = cell_index(shifted, length);
  const float tint = unit_hash(column, row, m.seed + 2);
  const Eigen::Vector2f stretched(0.12F * shifted + 3.7F * static_cast<float>(column), uv.y());
  const float fibre = fractal_noise(stretched, 0.02F, 2, 0.5F * footprint, m.seed + static_cast<std::uint32_t>(row));
  const Colour wood = mix(m.colour, m.accent, std::clamp(0.75F * tint + 0.5F * fibre, 0.0F, 1.0F));
  const float d = std::min(distance_to_multiple(uv.y(), m.scale), distance_to_multiple(shifted, length));
  return mix(wood, Colour(0.35F * m.accent), joint(d, 0.004F, footprint));
}

Colour books(const Material& m, const Eigen::Vector2f& uv, float footprint) {
  static const std::array<Colour, 8> cloth = {srgb(0x8c2f39), srgb(0x264653), srgb(0xe9c46a), srgb(0x2a9d8f),
                                              srgb(0xf4f1de), srgb(0x5f4b66), srgb(0xd9772b), srgb(0x3d5a40)};
  const auto left_edge = [&](int i) { return m.scale * (static_cast<float>(i) + 0.6F * unit_hash(i, 3, m.seed)); };
  int book = cell_index(uv.x(), m.scale);
  if (uv.x() < left_edge(book)) --book;
  const float to_side = std::min(uv.x() - left_edge(book), left_edge(book + 1) - uv.x());
  const float height = m.extent.y() * (0.68F + 0.27F * unit_hash(book, 5, m.seed));
  Colour spine = cloth[hash_cell(book, 7, m.seed) % cloth.size()];
  const float band_middle = height * (0.65F + 0.25F * unit_hash(book, 11, m.seed));
  const Colour band = cloth[hash_cell(book, 13, m.seed) % cloth.size()];
  spine = mix(spine, band, coverage(0.018F - std::abs(uv.y() - band_middle), footprint));
  spine = mix(spine, Colour(0.25F * spine), joint(to_side, 0.004F, footprint));
  const Colour shadow = 0.25F * m.accent;
  return mix(shadow, spine, coverage(height - uv.y(), footprint));
}

/// How much of a pixel the figure covers.
float shape_coverage(const Shape& shape, const Eigen::Vector2f& uv, float footprint) {
  const Eigen::Vector2f d = uv - shape.centre;
  if (shape.disc) return coverage(shape.half_size.x() - d.norm(), footprint);
  const Eigen::Vector2f& axis = shape.axis;
  return coverage(shape.half_size.x() - std::abs(axis.dot(d)), footprint) *
         coverage(shape.half_size.y() - std::abs(axis.x() * d.y() - axis.y() * d.x()), footprint);
}

Colour painted(const Material& m, const Eigen::Vector2f& uv, float footprint) {
  Colour colour = m.colour;
  for (const Shape& shape : m.shapes) colour = mix(colour, shape.colour, shape_coverage(shape, uv, footprint));
  const Eigen::Vector2f to_edge = uv.cwiseMin(m.extent - uv);
  return m.border > 0 ? mix(m.accent, colour, coverage(to_edge.minCoeff() - m.border, footprint)) : colour;
}

Colour pattern(const Material& m, const Eigen::Vector2f& uv, float footprint) {
  switch (m.texture) {
    case Texture::plain:
      return m.colour;
    case Texture::noise:
      return mix(m.colour, m.accent, 0.5F + 0.7F * fractal_noise(uv, m.scale, 3, footprint, m.seed));
    case Texture::tiles:
      return tiles(m, uv, footprint);
    case Texture::bricks:
      return bricks(m, uv, footprint);
    case Texture::planks:
      return planks(m, uv, footprint);
    case Texture::books:
      return books(m, uv, footprint);
    case Texture::shapes:
      return painted(m, uv, footprint);
  }
  return m.colour;
}

}  // namespace

Colour srgb(std::uint32_t code) {
  const auto linear = [](std::uint32_t byte) {
    const float c = static_cast<float>(byte & 0xffU) / 255.0F;
    return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
  };
  return {linear(code >> 16), linear(code >> 8), linear(code)};
}

Colour reflectance(const Material& material, const Eigen::Vector2f& uv, float footprint) {
  const float pixel = std::max(footprint, 1e-4F);
  const Colour colour = pattern(material, uv, pixel);
  if (material.grain <= 0.0F) return colour;
  return colour * (1.0F + material.grain * fractal_noise(uv, 0.06F, 3, pixel, material.seed + 101));
}

}  // namespace eg::synthetic
