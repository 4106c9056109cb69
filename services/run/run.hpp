#pragma once

#include "services/run/run_options.hpp"
#include "services/run/session.hpp"

namespace eg::run {

/// Checks everything, starts the services through procman-sheriff, follows the run to its end, and reports. Returns the
/// exit code: 0, 1 after a failure (one sentence on stderr), 130 when the user interrupted it. No process is left.
int run(const RunOptions& options, const StopCount& stops);

}  // namespace eg::run
