#pragma once

#include <cstdint>

/// Four numbers at once, by the vector types that GCC and Clang have on every processor. Each lane computes what a
/// scalar would, to the last bit. Comparisons give masks, and `mask ? a : b` chooses by lanes.
namespace eg::mapping {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));  ///< also the masks: all bits or none

inline Float4 all(float x) { return Float4{x, x, x, x}; }
inline Float4 min(Float4 a, Float4 b) { return a < b ? a : b; }
inline Float4 max(Float4 a, Float4 b) { return a > b ? a : b; }
inline Float4 abs(Float4 x) { return max(x, -x); }
inline Int4 truncate(Float4 x) { return __builtin_convertvector(x, Int4); }
inline Float4 to_float(Int4 x) { return __builtin_convertvector(x, Float4); }
inline bool any(Int4 mask) { return (mask[0] | mask[1] | mask[2] | mask[3]) != 0; }

}  // namespace eg::mapping
