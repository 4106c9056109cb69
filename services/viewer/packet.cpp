#include "services/viewer/packet.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace eg::services {
namespace {

static_assert(std::endian::native == std::endian::little, "packets are sent as they lie in memory");

constexpr std::size_t kAlignment = 4;

std::size_t padding(std::size_t bytes) { return (kAlignment - bytes % kAlignment) % kAlignment; }

}  // namespace

std::string json_string(std::string_view text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') json += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04x", static_cast<unsigned>(c));
      json += escape.data();
    } else {
      json += c;
    }
  }
  json += '"';
  return json;
}

Packet::Packet(std::string_view type) { set("type", type); }

Packet& Packet::set(std::string_view name, double value) {
  begin_field(name);
  std::array<char, 32> number{};
  std::snprintf(number.data(), number.size(), "%.17g", value);
  fields_ += std::isfinite(value) ? number.data() : "null";
  return *this;
}

Packet& Packet::set(std::string_view name, std::string_view text) {
  begin_field(name);
  fields_ += json_string(text);
  return *this;
}

Packet& Packet::set_flag(std::string_view name, bool value) {
  begin_field(name);
  fields_ += value ? "true" : "false";
  return *this;
}

Packet& Packet::array(std::string_view name, std::span<const float> values) {
  append_array(name, "f32", std::as_bytes(values), values.size());
  return *this;
}

Packet& Packet::array(std::string_view name, std::span<const std::uint32_t> values) {
  append_array(name, "u32", std::as_bytes(values), values.size());
  return *this;
}

Packet& Packet::array(std::string_view name, std::span<const std::int32_t> values) {
  append_array(name, "i32", std::as_bytes(values), values.size());
  return *this;
}

Packet& Packet::array(std::string_view name, std::span<const std::uint16_t> values) {
  append_array(name, "u16", std::as_bytes(values), values.size());
  return *this;
}

Packet& Packet::array(std::string_view name, std::span<const std::int8_t> values) {
  append_array(name, "i8", std::as_bytes(values), values.size());
  return *this;
}

Packet& Packet::array(std::string_view name, std::span<const std::uint8_t> values) {
  append_array(name, "u8", std::as_bytes(values), values.size());
  return *this;
}

std::vector<std::uint8_t> Packet::bytes() const {
  std::string head = "{";
  head.append(fields_).append(",\"arrays\":[").append(arrays_).append("]}");
  head.append(padding(head.size()), ' ');
  std::vector<std::uint8_t> bytes(sizeof(std::uint32_t) + head.size() + body_.size());
  const auto head_size = static_cast<std::uint32_t>(head.size());
  std::memcpy(bytes.data(), &head_size, sizeof head_size);
  std::memcpy(bytes.data() + sizeof head_size, head.data(), head.size());
  if (!body_.empty()) std::memcpy(bytes.data() + sizeof head_size + head.size(), body_.data(), body_.size());
  return bytes;
}

void Packet::begin_field(std::string_view name) {
  if (!fields_.empty()) fields_ += ',';
  fields_.append(json_string(name)).append(":");
}

void Packet::append_array(std::string_view name, const char* element, std::span<const std::byte> bytes,
                          std::size_t count) {
  if (!arrays_.empty()) arrays_ += ',';
  arrays_.append("[").append(json_string(name)).append(",\"").append(element).append("\",");
  arrays_.append(std::to_string(count)).append("]");
  const std::size_t start = body_.size();
  body_.resize(start + bytes.size() + padding(bytes.size()));
  if (!bytes.empty()) std::memcpy(body_.data() + start, bytes.data(), bytes.size());
}

}  // namespace eg::services
