#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <vector>

namespace eg::procman {

/// Load and memory of this machine.
struct HostUsage {
  double cpu_load = 0;  ///< of all processors since the measurement before, in [0, 1]
  std::int64_t memory_total_bytes = 0;
  std::int64_t memory_free_bytes = 0;  ///< available without swapping
  std::int64_t swap_total_bytes = 0;
  std::int64_t swap_free_bytes = 0;
};

/// Takes it from /proc.
class HostMeter {
 public:
  HostUsage measure();

 private:
  std::int64_t busy_ticks_ = 0;
  std::int64_t all_ticks_ = 0;
};

/// What a process and its descendants have used.
struct ProcessUsage {
  double cpu_seconds = 0;  ///< of those that still live
  std::int64_t virtual_bytes = 0;
  std::int64_t resident_bytes = 0;
};

/// Of each of `roots` with its descendants, in their order; zeros for what does not live.
std::vector<ProcessUsage> measure_processes(const std::vector<pid_t>& roots);

/// Number of processors in use.
int processor_count();

}  // namespace eg::procman
