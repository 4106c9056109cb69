#include "common/messages/wire.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "common/base/printable.hpp"

namespace eg::messages {
namespace {

constexpr std::size_t kFingerprintBytes = 8;
constexpr std::size_t kCountBytes = 4;
constexpr std::size_t kEmptyStringBytes = 5;  // length and the closing zero

std::uint64_t big_endian(ByteView bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8U | byte;
  return value;
}

std::int32_t read_int32(ByteView bytes, std::size_t at) {
  return static_cast<std::int32_t>(big_endian(bytes.subspan(at, 4)));
}

std::string hexadecimal(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(value));
  return text;
}

bool has_control_characters(std::string_view text) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (base::control_bytes_at(text, at) > 0) return true;
  }
  return false;
}

base::Status truncated(ByteView bytes, std::size_t expected) {
  return base::fail("the message is truncated: it has " + std::to_string(bytes.size()) + " of at least " +
                    std::to_string(expected) + " bytes");
}

base::Status check_fingerprint(ByteView bytes, const Layout& layout) {
  if (bytes.size() < kFingerprintBytes) return truncated(bytes, layout.fixed_bytes);
  const std::uint64_t fingerprint = big_endian(bytes.first(kFingerprintBytes));
  if (fingerprint == layout.fingerprint) return {};
  return base::fail("wrong type: the fingerprint is " + hexadecimal(fingerprint) + ", not " +
                    hexadecimal(layout.fingerprint) + " of " + layout.type);
}

/// The size of all arrays. The message has at least its fixed part.
base::Result<std::size_t> check_counts(ByteView bytes, const Layout& layout) {
  std::size_t arrays = 0;
  std::size_t at = kFingerprintBytes;
  for (const ArrayCount& array : layout.counts) {
    const std::int32_t count = read_int32(bytes, at);
    if (count < 0 || count > array.maximum) {
      return base::fail("field '" + std::string(array.name) + "' is " + std::to_string(count) + ", not in [0, " +
                        std::to_string(array.maximum) + "]");
    }
    arrays += static_cast<std::size_t>(count) * array.element_bytes;
    at += kCountBytes;
  }
  return arrays;
}

/// The size of the string at `at` behind its length. The length field itself is there.
base::Result<std::size_t> check_text(ByteView bytes, std::size_t at, const Text& text) {
  const std::string field = "field '" + std::string(text.name) + "' ";
  const std::int32_t length = read_int32(bytes, at);
  if (length < 1 || static_cast<std::size_t>(length) > text.maximum + 1) {
    return base::fail(field + "has " + std::to_string(std::int64_t{length} - 1) + " characters, not 0 to " +
                      std::to_string(text.maximum));
  }
  const auto size = static_cast<std::size_t>(length);
  if (at + 4 + size > bytes.size()) return tl::make_unexpected(truncated(bytes, at + 4 + size).error());
  const ByteView characters = bytes.subspan(at + 4, size);
  const std::string_view shown(reinterpret_cast<const char*>(characters.data()), size - 1);
  if (characters.back() != 0 || has_control_characters(shown)) {
    return base::fail(field + "is no printable text");
  }
  return size;
}

}  // namespace

base::Status check_layout(ByteView bytes, const Layout& layout) {
  if (const auto status = check_fingerprint(bytes, layout); !status) return status;
  if (bytes.size() < layout.fixed_bytes) return truncated(bytes, layout.fixed_bytes);
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    return base::fail("the message is too large");
  }
  const auto arrays = check_counts(bytes, layout);
  if (!arrays) return tl::make_unexpected(arrays.error());
  if (bytes.size() < layout.fixed_bytes + *arrays) return truncated(bytes, layout.fixed_bytes + *arrays);

  std::size_t at = layout.fixed_bytes + *arrays - kEmptyStringBytes * layout.texts.size();
  for (const Text& text : layout.texts) {
    if (at + 4 > bytes.size()) return truncated(bytes, at + 4);
    const auto size = check_text(bytes, at, text);
    if (!size) return tl::make_unexpected(size.error());
    at += 4 + *size;
  }
  if (at != bytes.size()) {
    return base::fail("the message has " + std::to_string(bytes.size()) + " bytes, not " + std::to_string(at));
  }
  return {};
}

std::string printable(std::string_view text, std::size_t maximum) {
  if (text.size() > maximum) {
    std::size_t end = maximum;
    const auto inside_character = [&](std::size_t i) { return (static_cast<unsigned char>(text[i]) & 0xc0U) == 0x80U; };
    while (end > 0 && inside_character(end)) --end;
    text = text.substr(0, end);
  }
  std::string result = base::printable(text);
  std::replace(result.begin(), result.end(), '\t', ' ');
  return result;
}

}  // namespace eg::messages
