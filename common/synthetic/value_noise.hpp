#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

namespace eg::synthetic {

/// A well-mixed 32-bit hash of a number (the finaliser of MurmurHash3).
inline std::uint32_t mix_bits(std::uint32_t h) {
  h = (h ^ (h >> 16)) * 0x85ebca6bU;
  h = (h ^ (h >> 13)) * 0xc2b2ae35U;
  return h ^ (h >> 16);
}

inline constexpr std::uint32_t kHashX = 0x9e3779b1U;
inline constexpr std::uint32_t kHashY = 0x85ebca77U;
inline constexpr std::uint32_t kHashSeed = 0xc2b2ae3dU;

/// A hash of a lattice cell.
inline std::uint32_t hash_cell(int x, int y, std::uint32_t seed) {
  return mix_bits(static_cast<std::uint32_t>(x) * kHashX + static_cast<std::uint32_t>(y) * kHashY + seed * kHashSeed);
}

/// A hash as a number in [0, 1).
inline float to_unit(std::uint32_t hash) {
  return static_cast<float>(static_cast<std::int32_t>(hash >> 8)) * 0x1.0p-24F;
}

inline float unit_hash(int x, int y, std::uint32_t seed) { return to_unit(hash_cell(x, y, seed)); }

/// The largest integer not above `x`; without the library call that std::floor is on the oldest processors we build
/// for.
inline int floor_to_int(float x) {
  const auto truncated = static_cast<int>(x);
  return truncated - (static_cast<float>(truncated) > x ? 1 : 0);
}

/// Value noise: random values on the integer lattice, joined by cubic blending; in [-1, 1], wavelength about 2.
inline float value_noise(const Eigen::Vector2f& p, std::uint32_t seed) {
  const int ix = floor_to_int(p.x());
  const int iy = floor_to_int(p.y());
  const auto blend = [](float t) { return t * t * (3.0F - 2.0F * t); };
  const auto between = [](float a, float b, float t) { return a + t * (b - a); };
  const float sx = blend(p.x() - static_cast<float>(ix));
  const float sy = blend(p.y() - static_cast<float>(iy));
  const std::uint32_t corner =
      static_cast<std::uint32_t>(ix) * kHashX + static_cast<std::uint32_t>(iy) * kHashY + seed * kHashSeed;
  const float low = between(to_unit(mix_bits(corner)), to_unit(mix_bits(corner + kHashX)), sx);
  const float high = between(to_unit(mix_bits(corner + kHashY)), to_unit(mix_bits(corner + kHashX + kHashY)), sx);
  return 2.0F * between(low, high, sy) - 1.0F;
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
