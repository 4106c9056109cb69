#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

/// What reader and writer of LCM logs share.
namespace eg::transport {

inline constexpr std::uint32_t kSyncWord = 0xeda1da01;
inline constexpr std::size_t kEventHeaderBytes = 4 + 8 + 8 + 4 + 4;  ///< sync word, number, time, two lengths

template <int Size>
std::uint64_t read_big_endian(const char* bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < Size; ++i) value = value << 8U | static_cast<std::uint8_t>(bytes[i]);
  return value;
}

/// Returns where the next field begins.
template <int Size>
char* write_big_endian(std::uint64_t value, char* bytes) {
  for (int i = 0; i < Size; ++i) bytes[i] = static_cast<char>(value >> (8 * (Size - 1 - i)));
  return bytes + Size;
}

inline std::array<char, 4> sync_word_bytes() {
  std::array<char, 4> bytes{};
  write_big_endian<4>(kSyncWord, bytes.data());
  return bytes;
}

}  // namespace eg::transport
