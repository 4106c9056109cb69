#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdlib>
#include <initializer_list>
#include <system_error>

#include "common/service/logging.hpp"
#include "services/procman_sheriff/lone_ranger.hpp"

namespace {

volatile std::sig_atomic_t stop_signals = 0;

void count_signal(int /*signal*/) { stop_signals = stop_signals + 1; }

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = count_signal;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) sigaction(signal, &action, nullptr);
  // Whoever reads this process's output may go first; the commands must still be stopped.
  std::signal(SIGPIPE, SIG_IGN);
}

/// Programs beside this one are found first.
void put_own_folder_on_path() {
  std::error_code failure;
  const auto executable = std::filesystem::read_symlink("/proc/self/exe", failure);
  if (failure) return;
  const char* path = std::getenv("PATH");
  const std::string rest = path != nullptr ? ":" + std::string(path) : "";
  setenv("PATH", (executable.parent_path().string() + rest).c_str(), 1);
}

}  // namespace

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

  catch_signals();
  put_own_folder_on_path();
  const eg::base::Status status =
      eg::procman_sheriff::run_lone_ranger(options, {[] { return stop_signals > 0; }, [] { return stop_signals > 1; }});
  if (status) return 0;
  spdlog::error(status.error().message);
  return 1;
}
