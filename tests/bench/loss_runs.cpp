// Runs in lockstep whose datagrams are dropped at random on arrival: whether they complete, whether their results are
// those of a run without losses to the last byte, and what the healing costs. In a network namespace of its own, with
// nft (Debian's nftables). Needs root.
//
//   bench_loss_runs [FRAMES [DATASET [PERCENT ...]]]
#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/bench/run_results.hpp"
#include "tests/support/private_network.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace eg;
using Clock = std::chrono::steady_clock;

constexpr char kUrl[] = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152";
constexpr std::chrono::seconds kLongestRun{3600};

struct Counter {
  long long packets = 0;
  double megabytes = 0.0;
};

struct Run {
  int exit_code = 1;
  double seconds = 0.0;
  Counter sent;
  Counter dropped;
};

std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* const pipe = popen(command.c_str(), "r");
  for (int c = 0; pipe != nullptr && (c = std::fgetc(pipe)) != EOF;) text.push_back(static_cast<char>(c));
  if (pipe != nullptr) pclose(pipe);
  return text;
}

/// The counter of the only rule of a chain.
Counter counter(const std::string& chain) {
  const std::string text = output_of("nft list chain ip lossy " + chain);
  const std::size_t at = text.find("counter packets ");
  Counter counter;
  long long bytes = 0;
  if (at != std::string::npos &&
      std::sscanf(text.c_str() + at, "counter packets %lld bytes %lld", &counter.packets, &bytes) == 2)
    counter.megabytes = 1e-6 * static_cast<double>(bytes);
  return counter;
}

bool drop(int percent) {
  const std::string rules =
      "nft 'flush ruleset; table ip lossy {"
      " chain out { type filter hook output priority 0; udp dport 7667 counter; };"
      " chain in { type filter hook input priority 0; udp dport 7667 numgen random mod 100 < " +
      std::to_string(percent) + " counter drop; }; }'";
  return std::system(rules.c_str()) == 0;
}

Run run(const std::string& frames, const std::string& dataset, const std::filesystem::path& out) {
  const auto start = Clock::now();
  test::Program program("egraph-run",
                        {"--dataset", dataset, "--frames", frames, "--lcm-url", kUrl, "--out", out.string()});
  Run run;
  run.exit_code = program.wait(kLongestRun);
  run.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  run.sent = counter("out");
  run.dropped = counter("in");
  if (run.exit_code != 0) spdlog::error("{}", program.output());
  return run;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> given(argv + 1, argv + argc);
  const std::string frames = given.empty() ? "60" : given[0];
  const std::string dataset = given.size() > 1 ? given[1] : "synthetic:room";
  std::vector<int> percents;
  for (std::size_t i = 2; i < given.size(); ++i) percents.push_back(std::atoi(given[i].c_str()));
  if (percents.empty()) percents = {1, 5, 20};

  if (const std::string why = test::enter_private_network(true); !why.empty()) {
    spdlog::error("{}", why);
    return 1;
  }
  const test::TemporaryFolder folder;
  const auto undisturbed = folder.path() / "0";
  if (!drop(0)) {
    spdlog::error("nft cannot be used: install nftables, and run this as root");
    return 1;
  }
  const Run whole = run(frames, dataset, undisturbed);
  if (whole.exit_code != 0) return 1;
  spdlog::info("no loss: {:.1f} s, {} datagrams, {:.1f} MB", whole.seconds, whole.sent.packets, whole.sent.megabytes);
  bool all_well = true;
  for (const int percent : percents) {
    if (!drop(percent)) return 1;
    const auto out = folder.path() / std::to_string(percent);
    const Run lossy = run(frames, dataset, out);
    const bool same = lossy.exit_code == 0 && bench::same_results(undisturbed, out);
    all_well = all_well && same;
    spdlog::info("{} %: {:.1f} s, {} of {} datagrams dropped, {:.1f} MB sent ({:+.0f} %), {}", percent, lossy.seconds,
                 lossy.dropped.packets, lossy.sent.packets, lossy.sent.megabytes,
                 100.0 * (lossy.sent.megabytes / whole.sent.megabytes - 1.0), same ? "the same bytes" : "OTHER bytes");
  }
  return all_well ? 0 : 1;
}
