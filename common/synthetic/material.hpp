#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace eg::synthetic {

/// Red, green, blue reflectance, linear in light, each in [0, 1].
using Colour = Eigen::Vector3f;

/// The linear colour of an sRGB triple 0xRRGGBB.
Colour srgb(std::uint32_t code);

enum class Texture : std::uint8_t {
  plain,   ///< one colour with faint unevenness
  noise,   ///< clouds between `colour` and `accent`
  tiles,   ///< square tiles of size `scale` in the two colours by turns, with joints
  bricks,  ///< running bond, bricks 3 x 1 of height `scale` in `colour`, joints in `accent`
  planks,  ///< boards along u of width `scale`, with grain and seams
  books,   ///< spines of mean width `scale` standing on v = 0, in many colours
  shapes,  ///< `shapes` painted over each other on `colour`, within a border of `accent`
};

/// One figure of a picture: a disc or a turned rectangle.
struct Shape {
  Eigen::Vector2f centre = Eigen::Vector2f::Zero();     ///< metres on the surface
  Eigen::Vector2f half_size = Eigen::Vector2f::Ones();  ///< metres; a disc takes x as its radius
  Eigen::Vector2f axis = Eigen::Vector2f::UnitX();      ///< unit vector along the first half size
  bool disc = false;
  Colour colour = Colour::Zero();
};

/// What a surface looks like. Textures are functions of the position on the surface in metres: no image is stored, and
/// no two places repeat.
struct Material {
  Texture texture = Texture::plain;
  Colour colour = Colour::Constant(0.8F);
  Colour accent = Colour::Constant(0.5F);
  float scale = 0.1F;   ///< size of the pattern, metres
  float grain = 0.05F;  ///< amplitude of the fine unevenness, share of the colour
  std::uint32_t seed = 0;
  Eigen::Vector2f extent = Eigen::Vector2f::Ones();  ///< size of the surface, for `shapes` and `books`
  float border = 0.0F;                               ///< width of the border of `shapes`, metres
  float glow = 0.0F;                                 ///< light the surface gives off itself, added to its shading
  std::vector<Shape> shapes = {};
};

/// The reflectance at `uv` (metres on the surface), averaged over a pixel's `footprint` (metres).
Colour reflectance(const Material& material, const Eigen::Vector2f& uv, float footprint);

/// A picture of the given size with seeded figures in harmonious colours on a border.
Material picture(const Eigen::Vector2f& extent, float border, std::uint32_t seed);

/// A rug of the given size: a border, and rows of lozenges.
Material rug(const Eigen::Vector2f& extent, std::uint32_t seed);

}  // namespace eg::synthetic
