#include "services/procman_sheriff/lone_ranger.hpp"

#include <spdlog/spdlog.h>

#include <cstdio>
#include <map>
#include <optional>

#include "common/procman/line_splitter.hpp"
#include "common/procman/script_runner.hpp"
#include "common/procman/supervisor.hpp"
#include "services/procman_sheriff/console.hpp"

namespace eg::procman_sheriff {
namespace {

using procman::Clock;
using procman::Command;
using procman::CommandId;
using procman::Configuration;

constexpr std::chrono::milliseconds kTick{20};

void print_output(const Command& command, const std::string& line) {
  std::fprintf(stderr, "%s\n", with_name(command.name, line).c_str());
}

/// Prints what the commands say and what becomes of them.
class Reporter {
 public:
  explicit Reporter(const Configuration& configuration) : commands_(configuration.commands) {}

  procman::CommandListener listener() {
    return {[this](CommandId id, std::string_view bytes) { output_[id].add(bytes, printer(id)); },
            [this](CommandId id, const std::string& event) { report(id, spdlog::level::info, event); },
            [this](CommandId id, const std::string& problem) {
              // What starts again by itself is not lost.
              report(id, commands_[id].auto_respawn ? spdlog::level::warn : spdlog::level::err, problem);
            }};
  }

 private:
  procman::LineSplitter::OnLine printer(CommandId id) {
    return [this, id](const std::string& line) { print_output(commands_[id], line); };
  }

  void report(CommandId id, spdlog::level::level_enum level, const std::string& event) {
    output_[id].flush(printer(id));
    spdlog::log(level, "{} {}", commands_[id].name, event);
  }

  const std::vector<Command>& commands_;
  std::map<CommandId, procman::LineSplitter> output_;
};

/// A lone ranger has no deputies on other machines.
base::Status check_hosts(const Configuration& configuration) {
  for (const Command& command : configuration.commands) {
    if (command.host.empty() || command.host == "localhost") continue;
    return procman::fail_at(configuration.file_name, command.place,
                            "command \"" + command.name + "\" is for host \"" + command.host +
                                "\", but --lone-ranger runs commands of \"localhost\" only");
  }
  return {};
}

base::Result<Configuration> load(const LoneRangerOptions& options) {
  auto configuration = procman::load_configuration(options.file);
  if (!configuration) return configuration;
  if (const base::Status hosts = check_hosts(*configuration); !hosts) return tl::make_unexpected(hosts.error());
  if (options.script.empty()) return configuration;
  if (const base::Status script = procman::check_script(*configuration, options.script); !script) {
    return tl::make_unexpected(script.error());
  }
  return configuration;
}

base::Status check_outcomes(const procman::Supervisor& supervisor) {
  for (std::size_t i = 0; i < supervisor.size(); ++i) {
    if (supervisor.outcome(i) == procman::Outcome::error) {
      return base::fail("command \"" + supervisor.command(i).name + "\" ended with an error");
    }
  }
  return {};
}

}  // namespace

base::Status run_lone_ranger(const LoneRangerOptions& options, const LoneRangerSignals& signals) {
  const auto configuration = load(options);
  if (!configuration) return tl::make_unexpected(configuration.error());

  Reporter reporter(*configuration);
  procman::Supervisor supervisor(configuration->commands, reporter.listener());
  std::optional<procman::ScriptRunner> script;
  if (options.script.empty()) {
    for (std::size_t i = 0; i < supervisor.size(); ++i) supervisor.start(i);
  } else {
    script.emplace(*configuration, supervisor, options.script, procman::ScriptRunner::Options{options.wait_limit});
  }
  base::Status status;
  while (!signals.stop()) {
    if (script) status = script->step(Clock::now());
    const bool done = !script || script->done();
    if (!status || (done && !supervisor.busy())) break;
    if (script && done && options.stop_on_script_complete) break;
    supervisor.poll(kTick);
  }
  if (status && !signals.stop()) status = check_outcomes(supervisor);
  supervisor.stop_all(signals.hurry);
  return status;
}

}  // namespace eg::procman_sheriff
