#pragma once

#include <cstdint>

#include "common/base/random.hpp"

namespace eg::synthetic {

/// A standard normal number from one draw: the sum of four 16-bit uniform numbers (Irwin and Hall), scaled to
/// variance 1. Its tails end at 3.46 sigma; for the noise of a million pixels per frame it is ten times cheaper than
/// exact ones.
inline double fast_normal(base::Random& random) {
  const std::uint64_t bits = random.next();
  const auto sum =
      static_cast<std::int32_t>((bits & 0xffffU) + ((bits >> 16) & 0xffffU) + ((bits >> 32) & 0xffffU) + (bits >> 48));
  constexpr double kMean = 2.0 * 65535.0;
  constexpr double kScale = 1.7320508075688772 / 65536.0;  // sqrt(12 / 4) per 2^16
  return kScale * (sum - kMean);
}

/// A generator for one row of an image: rows can then be made in any order.
inline base::Random row_random(std::uint64_t seed, int row) {
  return base::Random(base::Random(seed + 0xd1342543de82ef95ULL * static_cast<std::uint64_t>(row + 1)).next());
}

}  // namespace eg::synthetic
