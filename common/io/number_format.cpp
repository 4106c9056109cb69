#include "common/io/number_format.hpp"

#include <array>
#include <charconv>
#include <string_view>
#include <system_error>

#include "common/base/check.hpp"

namespace eg::io {
namespace {

/// Long enough for any double in fixed notation with a reasonable number of decimals.
constexpr std::size_t kBufferSize = 384;

template <typename... Format>
std::string formatted(double value, Format... format) {
  std::array<char, kBufferSize> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format...);
  EG_CHECK(error == std::errc{}, "a number does not fit into its buffer");
  return {buffer.data(), end};
}

/// Whether a text is zero with a minus sign, which would make equal results differ.
std::string without_negative_zero(std::string text) {
  const bool is_zero = std::string_view(text).find_first_of("123456789in") == std::string_view::npos;
  return is_zero && text.starts_with('-') ? text.substr(1) : text;
}

}  // namespace

std::string format_number(double value) { return formatted(value); }

std::string format_significant(double value, int digits) {
  return without_negative_zero(formatted(value, std::chars_format::general, digits));
}

std::string format_fixed(double value, int decimals) {
  return without_negative_zero(formatted(value, std::chars_format::fixed, decimals));
}

}  // namespace eg::io
