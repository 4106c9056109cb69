#pragma once

#include <cstdint>
#include <cstring>

/// Compiles a function, with all that it calls, for processors that have AVX2: the same operations in instructions of
/// three operands, which choose between two values at once. None of them fuses a product and a sum: the bits are the
/// same. Only to be called where processor_has_avx2().
#if defined(__x86_64__)
#define EG_AVX2 __attribute__((target("avx2"), flatten))
#else
#define EG_AVX2
#endif

/// Four numbers at once, by the vector types that GCC and Clang have on every processor. Each lane computes what a
/// scalar would, to the last bit. Comparisons give masks, and `mask ? a : b` chooses by lanes.
namespace eg::mapping {

inline bool processor_has_avx2() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));  ///< also the masks: all bits or none

inline Float4 all(float x) { return Float4{x, x, x, x}; }
inline Float4 load(const float* from) {
  Float4 values;
  std::memcpy(&values, from, sizeof values);
  return values;
}
inline Int4 load(const std::int32_t* from) {
  Int4 values;
  std::memcpy(&values, from, sizeof values);
  return values;
}
inline void store(Float4 values, float* to) { std::memcpy(to, &values, sizeof values); }
inline void store(Int4 values, std::int32_t* to) { std::memcpy(to, &values, sizeof values); }
inline Float4 min(Float4 a, Float4 b) { return a < b ? a : b; }
inline Float4 max(Float4 a, Float4 b) { return a > b ? a : b; }
inline Float4 abs(Float4 x) { return reinterpret_cast<Float4>(reinterpret_cast<Int4>(x) & 0x7fffffff); }
inline Int4 truncate(Float4 x) { return __builtin_convertvector(x, Int4); }
inline Float4 to_float(Int4 x) { return __builtin_convertvector(x, Float4); }
inline Int4 bits(Float4 x) { return reinterpret_cast<Int4>(x); }
inline Int4 sign(Float4 x) { return bits(x) < 0; }  ///< mask: has a minus sign, also of zero
inline bool any(Int4 mask) {
  using Long2 = std::int64_t __attribute__((vector_size(16)));
  const auto halves = reinterpret_cast<Long2>(mask);
  return (halves[0] | halves[1]) != 0;
}

inline float least(Float4 x) {
  const Float4 pairs = min(x, __builtin_shufflevector(x, x, 2, 3, 0, 1));
  return pairs[0] < pairs[1] ? pairs[0] : pairs[1];
}
inline float greatest(Float4 x) { return -least(-x); }

/// Two pairs of neighbours, from anywhere.
inline Float4 load_pairs(const float* first, const float* second) {
  using Float2 = float __attribute__((vector_size(8)));
  Float2 a, b;
  std::memcpy(&a, first, sizeof a);
  std::memcpy(&b, second, sizeof b);
  return __builtin_shufflevector(a, b, 0, 1, 2, 3);
}
inline Float4 evens(Float4 a, Float4 b) { return __builtin_shufflevector(a, b, 0, 2, 4, 6); }
inline Float4 odds(Float4 a, Float4 b) { return __builtin_shufflevector(a, b, 1, 3, 5, 7); }

}  // namespace eg::mapping
