#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace eg::synthetic {

/// A well-mixed 32-bit hash of a lattice cell (the finaliser of MurmurHash3 over a linear combination).
inline std::uint32_t hash_cell(int x, int y, std::uint32_t seed) {
  std::uint32_t h =
      static_cast<std::uint32_t>(x) * 0x9e3779b1U + static_cast<std::uint32_t>(y) * 0x85ebca77U + seed * 0xc2b2ae3dU;
  h = (h ^ (h >> 16)) * 0x85ebca6bU;
  h = (h ^ (h >> 13)) * 0xc2b2ae35U;
  return h ^ (h >> 16);
}

/// The same as a number in [0, 1).
inline float unit_hash(int x, int y, std::uint32_t seed) {
  return static_cast<float>(hash_cell(x, y, seed) >> 8) * 0x1.0p-24F;
}

/// Value noise: random values on the integer lattice, joined by cubic blending; in [-1, 1], wavelength about 2.
inline float value_noise(const Eigen::Vector2f& p, std::uint32_t seed) {
  const float fx = std::floor(p.x());
  const float fy = std::floor(p.y());
  const auto ix = static_cast<int>(fx);
  const auto iy = static_cast<int>(fy);
  const auto blend = [](float t) { return t * t * (3.0F - 2.0F * t); };
  const float sx = blend(p.x() - fx);
  const float sy = blend(p.y() - fy);
  const float low = std::lerp(unit_hash(ix, iy, seed), unit_hash(ix + 1, iy, seed), sx);
  const float high = std::lerp(unit_hash(ix, iy + 1, seed), unit_hash(ix + 1, iy + 1, seed), sx);
  return 2.0F * std::lerp(low, high, sy) - 1.0F;
}

/// Octaves of value noise, each half as large and twice as fine, in about [-1, 1]. `cell` is the lattice size of the
/// first in metres. Octaves finer than the pixel's footprint (metres) fade out, which is what a camera's pixel does to
/// them.
inline float fractal_noise(const Eigen::Vector2f& p, float cell, int octaves, float footprint, std::uint32_t seed) {
  float sum = 0.0F;
  float amplitude = 0.5F;
  for (int octave = 0; octave < octaves; ++octave, amplitude *= 0.5F, cell *= 0.5F) {
    const float fade = std::clamp(2.0F - 2.0F * footprint / cell, 0.0F, 1.0F);
    if (fade <= 0.0F) break;
    sum += amplitude * fade * value_noise(p / cell, seed + static_cast<std::uint32_t>(octave));
  }
  return sum;
}

}  // namespace eg::synthetic
