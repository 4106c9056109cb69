#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

#include "common/base/result.hpp"

namespace eg::procman_sheriff {

/// A sheriff that is its own deputy: it runs the commands of a configuration itself, on this machine, without LCM.
struct LoneRangerOptions {
  std::filesystem::path file;
  std::string script;                           ///< empty: start everything
  std::chrono::milliseconds wait_limit{30000};  ///< for each wait of the script
  bool stop_on_script_complete = false;         ///< instead of when the commands have ended
};

/// Asked all the time.
struct LoneRangerSignals {
  std::function<bool()> stop;   ///< true: stop everything and return
  std::function<bool()> hurry;  ///< true: kill instead of stopping
};

/// Runs the script and then supervises the commands until all have ended or `stop` says so; then stops what still runs,
/// the last started first. Nothing it started is left when it returns. An error if the configuration or the script is
/// wrong, a wait failed, or a command ended with an error and nobody asked to stop.
base::Status run_lone_ranger(const LoneRangerOptions& options, const LoneRangerSignals& signals);

}  // namespace eg::procman_sheriff
