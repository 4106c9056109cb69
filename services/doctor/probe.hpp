#pragma once

#include "common/transport/bus.hpp"
#include "services/doctor/finding.hpp"

namespace eg::doctor {

/// Sends messages of an image's size at a camera's rate to itself, on a channel that nobody else listens to, and counts
/// what comes back.
Finding probe(transport::Bus& bus);

}  // namespace eg::doctor
