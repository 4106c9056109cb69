#include "common/io/time_stamp.hpp"

#include <cmath>

#include "common/io/text_file.hpp"

namespace eg::io {
namespace {

constexpr double kLatestTime = 1e12;
// Integers above this (nine hours at 30 Hz) are whole seconds since some epoch, not image numbers.
constexpr long long kLargestIndex = 1'000'000;

}  // namespace

std::optional<TimeStamp> parse_time_stamp(std::string_view text) {
  const auto value = parse_number(text);
  if (!value || *value < 0.0 || *value >= kLatestTime) return std::nullopt;
  const auto integer = parse_integer(text);
  return TimeStamp{*value, integer && *integer <= kLargestIndex};
}

std::int64_t to_utime(double time_s) { return std::llround(time_s * 1e6); }

}  // namespace eg::io
