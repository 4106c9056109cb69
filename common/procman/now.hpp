#pragma once

#include <chrono>
#include <cstdint>

namespace eg::procman {

using Clock = std::chrono::steady_clock;

/// Both clocks: one that never jumps, and the one that messages carry, microseconds.
struct Now {
  Clock::time_point time;
  std::int64_t utime = 0;
};

}  // namespace eg::procman
