#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/eval/trajectory_errors.hpp"
#include "services/run/input.hpp"
#include "services/run/run_monitor.hpp"
#include "services/run/run_options.hpp"

namespace eg::run {

/// How a run went.
struct RunReport {
  std::string result;                            ///< "complete", "interrupted" or "failed"
  std::string failure;                           ///< why it failed; else empty
  double wall_seconds = 0.0;                     ///< from the start of the services to their end
  double processing_seconds = 0.0;               ///< from the first to the last finished frame
  std::optional<eval::TrajectoryErrors> errors;  ///< if there is ground truth
};

/// Compares out/trajectory.txt with the ground truth. Nothing if either is missing; an error if one cannot be read.
base::Result<std::optional<eval::TrajectoryErrors>> evaluate(const std::filesystem::path& out, const Input& input);

/// Writes status.json: the run, and per service frames, drops, latencies, CPU time and memory.
base::Status write_status(const std::filesystem::path& file, const RunOptions& options, const Input& input,
                          const RunMonitor& monitor, const RunReport& report);

/// The last lines on the terminal: frames, errors, files.
std::string summarise(const std::filesystem::path& out, const RunMonitor& monitor, const RunReport& report);

}  // namespace eg::run
