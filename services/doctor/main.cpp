#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iterator>
#include <string>

#include "common/transport/lcm_bus.hpp"
#include "services/doctor/live_view.hpp"
#include "services/doctor/machine_checks.hpp"
#include "services/doctor/probe.hpp"

namespace {

using namespace eg;
using namespace eg::doctor;
using Clock = std::chrono::steady_clock;

void append(Findings& findings, Findings more) { std::move(more.begin(), more.end(), std::back_inserter(findings)); }

std::int64_t now_utime() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

void print(const Findings& findings) {
  constexpr const char* kWords[] = {"ok", "warning", "error"};
  for (const Finding& finding : findings) {
    std::printf("%-8s %s\n", kWords[static_cast<int>(finding.severity)], finding.what.c_str());
    if (!finding.mend.empty()) std::printf("         mend: %s\n", finding.mend.c_str());
  }
}

bool any(const Findings& findings, Severity severity) {
  return std::any_of(findings.begin(), findings.end(), [&](const Finding& f) { return f.severity == severity; });
}

/// Listens for a while; what is wrong with what was heard, and with the network meanwhile.
Findings listen(const transport::LcmBus::Options& options, double seconds) {
  auto bus = transport::LcmBus::create(options);
  if (!bus) return {{Severity::error, bus.error().message, ""}};
  Findings findings = {probe(**bus)};
  LiveView view(**bus);
  const KernelDrops before = kernel_drops();
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end) {
    if (const auto handled = (*bus)->handle(std::chrono::milliseconds(20)); !handled) {
      findings.push_back({Severity::error, handled.error().message, "start the doctor again"});
      break;
    }
  }
  append(findings, view.judge(now_utime()));
  append(findings, check_drops(before, kernel_drops()));
  std::fputs(view.format().c_str(), stdout);
  return findings;
}

}  // namespace

int main(int argc, char** argv) {
  transport::LcmBus::Options options;
  double seconds = 4.0;
  CLI::App app(
      "Checks what LCM needs of this machine, listens to what runs, says what is wrong and what to type against it. "
      "Exit code 0: all is well, 1: something does not work, 2: something works badly",
      "egraph-doctor");
  app.add_option("--lcm-url", options.url, "LCM provider that the services use")
      ->envname("EGRAPH_LCM_URL")
      ->capture_default_str();
  app.add_option("--channel-prefix", options.channel_prefix, "Of the services to listen to")
      ->envname("EGRAPH_CHANNEL_PREFIX");
  app.add_option("--seconds", seconds, "How long to listen")->check(CLI::Range(0.0, 86400.0))->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  try {
    Findings findings = check_machine(options.url);
    if (!any(findings, Severity::error)) append(findings, listen(options, seconds));
    print(findings);
    return any(findings, Severity::error) ? 1 : any(findings, Severity::warning) ? 2 : 0;
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "egraph-doctor: %s\n", exception.what());
    return 1;
  }
}
