#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <csignal>

#include "common/procman/guardian.hpp"
#include "common/procman/own_folder.hpp"
#include "common/service/logging.hpp"
#include "services/procman_sheriff/lone_ranger.hpp"

int main(int argc, char** argv) {
  eg::service::log_to_stderr("procman-sheriff");
  bool lone_ranger = false;
  double wait_limit_s = 30.0;
  eg::procman_sheriff::LoneRangerOptions options;

  CLI::App app("Starts, supervises and stops the processes of a procman configuration", "procman-sheriff");
  app.add_flag("-l,--lone-ranger", lone_ranger, "Run the commands here, without deputies")->required();
  app.add_option("--wait-limit", wait_limit_s, "Longest time that a wait in a script may take, seconds")
      ->check(CLI::Range(0.001, 86400.0))
      ->capture_default_str();
  app.add_option("FILE", options.file, "procman configuration (.pmd)")->required();
  app.add_option("SCRIPT", options.script, "Script to run; without it all commands are started");
  CLI11_PARSE(app, argc, argv);
  options.wait_limit = std::chrono::milliseconds(static_cast<std::int64_t>(1000.0 * wait_limit_s));

  // Whoever reads this process's output may go first; the commands must still be stopped.
  std::signal(SIGPIPE, SIG_IGN);
  eg::procman::put_own_folder_on_path();
  return eg::procman::run_guarded([&] {
    const eg::base::Status status = eg::procman_sheriff::run_lone_ranger(
        options, {[] { return eg::procman::stop_count() > 0; },
                  [] { return eg::procman::stop_count() >= eg::procman::kStopAtOnce; }});
    if (status) return 0;
    spdlog::error(status.error().message);
    return 1;
  });
}
