#include "common/base/printable.hpp"

#include <algorithm>

namespace eg::base {

std::size_t control_bytes_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(at) < 0x20 || byte(at) == 0x7f) return 1;
  const bool second_row = byte(at) == 0xc2 && at + 1 < text.size() && byte(at + 1) >= 0x80 && byte(at + 1) <= 0x9f;
  return second_row ? 2 : 0;
}

std::string printable(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t control = text[at] == '\t' ? 0 : control_bytes_at(text, at);
    result += control > 0 ? ' ' : text[at];
    at += std::max<std::size_t>(control, 1);
  }
  return result;
}

}  // namespace eg::base
