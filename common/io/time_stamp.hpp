#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace eg::io {

/// A time as a file gives it: seconds, or the number of an image.
struct TimeStamp {
  double value = 0.0;
  bool maybe_index = false;  ///< written as a small integer without a decimal point
};

/// A non-negative time below 1e12 s, so that its microseconds fit into 64 bits; anything else is none.
std::optional<TimeStamp> parse_time_stamp(std::string_view text);

/// Seconds to the project's microseconds, rounded.
std::int64_t to_utime(double time_s);

}  // namespace eg::io
