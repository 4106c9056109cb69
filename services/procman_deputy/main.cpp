#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>

#include "common/procman/guardian.hpp"
#include "common/procman/own_folder.hpp"
#include "common/service/logging.hpp"
#include "common/transport/lcm_bus.hpp"
#include "services/procman_deputy/deputy_service.hpp"

namespace {

using namespace eg;

struct CommandLine {
  std::string name;
  std::string lcm_url = transport::kDefaultLcmUrl;
  bool remote = false;
  std::filesystem::path allow_only;
};

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "localhost";
}

int report(const std::string& message) {
  spdlog::error(message);
  return 1;
}

int run(const CommandLine& line, pid_t nonce) {
  procman::Deputy::Options options;
  options.name = line.name;
  options.nonce = nonce;
  if (!line.allow_only.empty()) {
    auto allowed = procman::load_configuration(line.allow_only);
    if (!allowed) return report(allowed.error().message);
    options.allowed = *std::move(allowed);
  }
  if (transport::time_to_live(line.lcm_url) > 0 && !line.remote) {
    return report("the LCM URL " + line.lcm_url +
                  " reaches beyond this machine: give --remote if others on that network may run commands here");
  }
  const auto bus = transport::LcmBus::create({line.lcm_url, "", !line.remote});
  if (!bus) return report(bus.error().message);
  procman_deputy::DeputyService service(**bus, std::move(options));
  if (const auto subscribed = service.subscribe(); !subscribed) return report(subscribed.error().message);
  spdlog::info("deputy \"{}\" on {}", line.name, line.lcm_url);
  return service.run(procman::stop_count);
}

}  // namespace

int main(int argc, char** argv) {
  service::log_to_stderr("procman-deputy");
  CommandLine line;
  line.name = host_name();
  CLI::App app("Runs the commands that a procman sheriff orders", "procman-deputy");
  app.add_option("-n,--name,-i,--id", line.name, "Name of this deputy, the 'host' of its commands")
      ->capture_default_str();
  app.add_option("-u,--lcm-url", line.lcm_url, "LCM provider to talk on")
      ->envname("EGRAPH_LCM_URL")
      ->capture_default_str();
  app.add_flag("--remote", line.remote,
               "Also obey sheriffs on other machines; LCM has no authentication, so whoever reaches this network can "
               "then run any command here");
  app.add_option("--allow-only", line.allow_only, "Run only the commands of this configuration, word by word (.pmd)");
  CLI11_PARSE(app, argc, argv);

  std::signal(SIGPIPE, SIG_IGN);  // whoever reads this process's output may go first
  procman::put_own_folder_on_path();
  setenv("EGRAPH_LCM_URL", line.lcm_url.c_str(), 1);  // where its commands meet, unless they say otherwise
  const pid_t own_pid = getpid();
  return procman::run_guarded([&] { return run(line, own_pid); });
}
