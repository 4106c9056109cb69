#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <map>

#include "common/procman/guardian.hpp"
#include "common/procman/own_folder.hpp"
#include "common/service/logging.hpp"
#include "common/transport/lcm_bus.hpp"
#include "services/procman_sheriff/lone_ranger.hpp"
#include "services/procman_sheriff/sheriff_service.hpp"

namespace {

using namespace eg;
using procman_sheriff::OnScriptComplete;

struct CommandLine {
  std::filesystem::path file;
  bool lone_ranger = false;
  std::string lcm_url = transport::kDefaultLcmUrl;
  double wait_limit_s = 30.0;
  procman_sheriff::SheriffOptions sheriff;
};

void add_options(CLI::App& app, CommandLine& line) {
  static const std::map<std::string, OnScriptComplete> kCompletions = {
      {"stay", OnScriptComplete::stay}, {"exit", OnScriptComplete::exit}, {"observe", OnScriptComplete::observe}};
  app.add_flag("-l,--lone-ranger", line.lone_ranger,
               "Run the commands here, without LCM and deputies; at the end, stop them");
  app.add_option("-u,--lcm-url", line.lcm_url, "LCM provider on which the deputies are")
      ->envname("EGRAPH_LCM_URL")
      ->capture_default_str();
  app.add_option("--on-script-complete", line.sheriff.on_script_complete,
                 "When the script is done: 'stay' (the default) goes on ordering, 'exit' ends and leaves the deputies "
                 "what they run, 'observe' goes on showing")
      ->transform(CLI::Transformer(kCompletions).description("stay|exit|observe"));
  app.add_option("--wait-limit", line.wait_limit_s, "Longest time that a wait in a script may take, seconds")
      ->check(CLI::Range(0.001, 86400.0))
      ->capture_default_str();
  app.add_flag("--observe", line.sheriff.observe, "Order nothing, just show what the deputies do");
  app.add_option("FILE", line.file, "procman configuration (.pmd)")->required();
  app.add_option("SCRIPT", line.sheriff.script, "Script to run; without it all commands are started");
}

base::Status run_with_deputies(const CommandLine& line) {
  const auto configuration = procman::load_configuration(line.file);
  if (!configuration) return tl::make_unexpected(configuration.error());
  if (!line.sheriff.script.empty()) {
    if (auto checked = procman::check_script(*configuration, line.sheriff.script); !checked) return checked;
  }
  const auto bus = transport::LcmBus::create({line.lcm_url, ""});
  if (!bus) return tl::make_unexpected(bus.error());
  procman_sheriff::SheriffService service(**bus, *configuration, line.sheriff);
  if (auto subscribed = service.subscribe(); !subscribed) return subscribed;
  return service.run([] { return procman::stop_count() > 0; });
}

base::Status run_alone(const CommandLine& line) {
  procman_sheriff::LoneRangerOptions options;
  options.file = line.file;
  options.script = line.sheriff.script;
  options.wait_limit = line.sheriff.wait_limit;
  options.stop_on_script_complete = line.sheriff.on_script_complete == OnScriptComplete::exit;
  return procman_sheriff::run_lone_ranger(options, {[] { return procman::stop_count() > 0; },
                                                    [] { return procman::stop_count() >= procman::kStopAtOnce; }});
}

}  // namespace

int main(int argc, char** argv) {
  service::log_to_stderr("procman-sheriff");
  CommandLine line;
  CLI::App app("Starts, supervises and stops the processes of a procman configuration", "procman-sheriff");
  add_options(app, line);
  CLI11_PARSE(app, argc, argv);
  line.sheriff.wait_limit = std::chrono::milliseconds(static_cast<std::int64_t>(1000.0 * line.wait_limit_s));

  // Whoever reads this process's output may go first; the commands must still be stopped.
  std::signal(SIGPIPE, SIG_IGN);
  procman::put_own_folder_on_path();
  return procman::run_guarded([&line] {
    const base::Status status = line.lone_ranger ? run_alone(line) : run_with_deputies(line);
    if (status) return 0;
    spdlog::error(status.error().message);
    return 1;
  });
}
