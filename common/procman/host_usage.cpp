#include "common/procman/host_usage.hpp"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <set>
#include <string>

#include "common/procman/process_tree.hpp"

namespace eg::procman {
namespace {

struct Ticks {
  std::int64_t busy = 0;
  std::int64_t all = 0;
};

/// The first line of /proc/stat: "cpu user nice system idle iowait irq softirq steal ...".
Ticks read_processor_ticks() {
  std::ifstream stream("/proc/stat");
  std::string name;
  stream >> name;
  Ticks ticks;
  constexpr int kFields = 8;  // guest time, which follows, is within user time
  for (int field = 0; field < kFields; ++field) {
    std::int64_t value = 0;
    stream >> value;
    const bool idle = field == 3 || field == 4;
    ticks.all += value;
    if (!idle) ticks.busy += value;
  }
  return ticks;
}

/// A line of /proc/meminfo: "MemTotal:  16384 kB".
void read_memory(HostUsage& usage) {
  std::ifstream stream("/proc/meminfo");
  std::string key;
  std::int64_t kilobytes = 0;
  while (stream >> key >> kilobytes) {
    const std::int64_t bytes = 1024 * kilobytes;
    if (key == "MemTotal:") usage.memory_total_bytes = bytes;
    if (key == "MemAvailable:") usage.memory_free_bytes = bytes;
    if (key == "SwapTotal:") usage.swap_total_bytes = bytes;
    if (key == "SwapFree:") usage.swap_free_bytes = bytes;
    stream.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
}

}  // namespace

HostUsage HostMeter::measure() {
  HostUsage usage;
  const Ticks ticks = read_processor_ticks();
  const std::int64_t all = ticks.all - all_ticks_;
  if (all > 0)
    usage.cpu_load = std::clamp(static_cast<double>(ticks.busy - busy_ticks_) / static_cast<double>(all), 0.0, 1.0);
  busy_ticks_ = ticks.busy;
  all_ticks_ = ticks.all;
  read_memory(usage);
  return usage;
}

std::vector<ProcessUsage> measure_processes(const std::vector<pid_t>& roots) {
  const std::vector<Process> processes = list_processes();
  const double ticks_per_second = static_cast<double>(sysconf(_SC_CLK_TCK));
  const std::int64_t page_bytes = sysconf(_SC_PAGESIZE);
  std::vector<ProcessUsage> usages;
  for (const pid_t root : roots) {
    ProcessUsage& usage = usages.emplace_back();
    if (root == 0) continue;  // of which everything descends
    const std::set<pid_t> members = with_descendants(processes, {root});
    for (const Process& process : processes) {
      if (!members.contains(process.pid)) continue;
      usage.cpu_seconds += static_cast<double>(process.cpu_ticks) / ticks_per_second;
      usage.virtual_bytes += process.virtual_bytes;
      usage.resident_bytes += process.resident_pages * page_bytes;
    }
  }
  return usages;
}

int processor_count() { return static_cast<int>(std::max(1L, sysconf(_SC_NPROCESSORS_ONLN))); }

}  // namespace eg::procman
