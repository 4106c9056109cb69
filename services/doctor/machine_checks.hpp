#pragma once

#include <string>

#include "services/doctor/finding.hpp"

namespace eg::doctor {

/// What this machine lets LCM do at this URL, found without sending anything: URL, multicast route and its device, ttl,
/// receive buffer, who listens on the port, versions.
Findings check_machine(const std::string& lcm_url);

/// Datagrams that the kernel has thrown away since it booted.
struct KernelDrops {
  std::int64_t full_buffers = 0;          ///< UDP datagrams that found a full receive buffer
  std::int64_t incomplete_datagrams = 0;  ///< IP fragments that could not be put together
};

KernelDrops kernel_drops();

/// What was thrown away between two looks.
Findings check_drops(const KernelDrops& before, const KernelDrops& after);

}  // namespace eg::doctor
