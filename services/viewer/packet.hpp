#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace eg::services {

/// One binary message to the browsers:
///
///   uint32 size of the head in bytes, a multiple of 4 | head | arrays, each padded to a multiple of 4 bytes
///
/// all little-endian. The head is JSON, padded with spaces: {"type": ..., fields..., "arrays": [[name, element, count],
/// ...]}; element is f32, u32, i32, u16, i8 or u8. The page's packet.js reads it without copying an array.
class Packet {
 public:
  explicit Packet(std::string_view type);

  Packet& set(std::string_view name, double value);  ///< not finite: null
  Packet& set(std::string_view name, std::string_view text);
  Packet& set_flag(std::string_view name, bool value);

  Packet& array(std::string_view name, std::span<const float> values);
  Packet& array(std::string_view name, std::span<const std::uint32_t> values);
  Packet& array(std::string_view name, std::span<const std::int32_t> values);
  Packet& array(std::string_view name, std::span<const std::uint16_t> values);
  Packet& array(std::string_view name, std::span<const std::int8_t> values);
  Packet& array(std::string_view name, std::span<const std::uint8_t> values);

  [[nodiscard]] std::vector<std::uint8_t> bytes() const;

 private:
  void begin_field(std::string_view name);
  void append_array(std::string_view name, const char* element, std::span<const std::byte> bytes, std::size_t count);

  std::string fields_;
  std::string arrays_;
  std::vector<std::uint8_t> body_;
};

/// The text as a JSON string, with its quotes. Bytes that are not printable ASCII are escaped or passed on as they are
/// (UTF-8).
std::string json_string(std::string_view text);

}  // namespace eg::services
