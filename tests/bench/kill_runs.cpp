// Runs that are disturbed by kill -9 of their services at random times, until there were as many kills as asked for:
// whether every run completes, and whether its results are those of an undisturbed run to the last byte.
//
//   bench_kill_runs [KILLS [FRAMES [DATASET [SEED [SECONDS]]]]]
//
// SECONDS: the longest pause between two kills (3). A tracker needs time to track its frames again: who kills faster
// than that on a busy machine sees egraph-run give up, as it should.
#include <spdlog/spdlog.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <map>
#include <thread>

#include "common/base/random.hpp"
#include "tests/bench/run_results.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace eg;
using Clock = std::chrono::steady_clock;

constexpr std::array kServices = {"frame_source", "feature_extractor", "egraph_server", "tracker", "mapper"};
constexpr std::chrono::seconds kLongestRun{3600};
constexpr double kShortestPause = 0.2;  // seconds between two kills

struct Input {
  std::string dataset = "synthetic:room";
  std::string frames = "300";
};

std::vector<std::string> arguments(const Input& input, const std::filesystem::path& out) {
  return {"--dataset", input.dataset, "--frames", input.frames, "--out", out.string()};
}

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Kills services of a run until it ends or `kills` are done; counts them by name.
void disturb(test::Program& run, const std::filesystem::path& log, int kills, double longest_pause,
             base::Random& random, std::map<std::string, int>& killed) {
  if (!run.wait_for_output("  tracking ", std::chrono::seconds(120))) return;
  for (; kills > 0; --kills) {
    const double pause = kShortestPause + (longest_pause - kShortestPause) * random.uniform();
    std::this_thread::sleep_for(std::chrono::duration<double>(pause));
    if (run.wait(std::chrono::seconds(0)) >= 0) return;
    const std::string service = kServices[random.index(kServices.size())];
    const pid_t pid = test::service_pid(log, service);
    if (pid > 0 && kill(pid, SIGKILL) == 0) ++killed[service];
  }
}

int count(const std::map<std::string, int>& killed) {
  int sum = 0;
  for (const auto& [service, times] : killed) sum += times;
  return sum;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> given(argv + 1, argv + argc);
  const int kills = given.empty() ? 100 : std::atoi(given[0].c_str());
  Input input;
  if (given.size() > 1) input.frames = given[1];
  if (given.size() > 2) input.dataset = given[2];
  base::Random random(given.size() > 3 ? std::strtoull(given[3].c_str(), nullptr, 10) : 1);

  const double longest_pause = given.size() > 4 ? std::atof(given[4].c_str()) : 3.0;
  const test::TemporaryFolder folder;
  const auto undisturbed = folder.path() / "undisturbed";
  auto start = Clock::now();
  test::Program reference("egraph-run", arguments(input, undisturbed));
  if (reference.wait(kLongestRun) != 0) {
    spdlog::error("the undisturbed run failed: {}", reference.output());
    return 1;
  }
  spdlog::info("undisturbed: {} frames in {:.1f} s", input.frames, seconds_since(start));

  std::map<std::string, int> killed;
  bool all_well = true;
  for (int runs = 1; count(killed) < kills; ++runs) {
    const auto out = folder.path() / std::to_string(runs);
    const int before = count(killed);
    start = Clock::now();
    test::Program run("egraph-run", arguments(input, out));
    disturb(run, out / "log.txt", kills - before, longest_pause, random, killed);
    const bool complete = run.wait(kLongestRun) == 0;
    const bool same = complete && bench::same_results(undisturbed, out);
    spdlog::info("run {}: {} kills, {:.1f} s, {}, {}", runs, count(killed) - before, seconds_since(start),
                 complete ? "complete" : "NOT complete", same ? "the same bytes" : "OTHER bytes");
    if (!complete) spdlog::error("{}", run.output());
    all_well = all_well && same;
    if (count(killed) == before) break;
  }
  for (const auto& [service, times] : killed) spdlog::info("{} killed {} times", service, times);
  if (!test::no_process_is_left()) spdlog::error("processes are left");
  return all_well ? 0 : 1;
}
