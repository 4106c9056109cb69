#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace eg::io {

/// Polynomials of 32 bits, reflected.
inline constexpr std::uint32_t kCrcIso3309 = 0xedb88320U;     ///< of PNG (PNG specification, annex D)
inline constexpr std::uint32_t kCrcCastagnoli = 0x82f63b78U;  ///< CRC-32C

/// The cyclic redundancy check of `bytes`, a byte at a time by table. `before`: of the bytes that stand before them.
template <std::uint32_t Polynomial>
std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0) {
  static constexpr std::array<std::uint32_t, 256> kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
      std::uint32_t remainder = byte;
      for (int bit = 0; bit < 8; ++bit) remainder = (remainder >> 1U) ^ ((remainder & 1U) != 0 ? Polynomial : 0U);
      table[byte] = remainder;
    }
    return table;
  }();
  std::uint32_t crc = ~before;
  for (const char c : bytes) crc = (crc >> 8U) ^ kTable[(crc ^ static_cast<unsigned char>(c)) & 0xffU];
  return ~crc;
}

}  // namespace eg::io
