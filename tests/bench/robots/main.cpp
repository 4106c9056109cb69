// How many robots one E-Graph server and one network carry. Robots are played from a recorded run, in real time, each
// with a channel prefix of its own; they are on one machine (network namespace), the server on another, joined by a
// veth pair. Needs root.
//
//   bench_robots LOG graph|all SECONDS ROBOTS [ROBOTS ...]
//
// LOG: run.lcm of egraph-run --log. graph: what must reach the server and viewers crosses the network (KEYFRAME, POSE
// and the answers); all: images and features, too, as when every process has a URL with ttl=1.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>

#include "common/messages/channels.hpp"
#include "common/transport/event_log.hpp"
#include "common/transport/lcm_bus.hpp"
#include "tests/bench/robots/played_robot.hpp"
#include "tests/support/hosts.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace eg;
using bench::Clock;
using bench::PlayedRobot;
using bench::RecordedRobot;
namespace channels = messages::channels;

constexpr char kUrl[] = "udpm://239.255.76.67:7992?ttl=1&recv_buf_size=2097152";
constexpr int kRobotsHost = 0;
constexpr int kServerHost = 1;
constexpr std::chrono::seconds kAnswerLimit{5};  // after the last announcement

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

base::Result<RecordedRobot> read_recording(const std::string& path, bool with_images) {
  auto log = transport::EventLogReader::open(path);
  if (!log) return tl::make_unexpected(log.error());
  RecordedRobot robot;
  struct Sum {
    std::size_t bytes = 0;
    std::size_t messages = 0;
  };
  std::map<std::string, Sum> streams = {{channels::kPose, {}}};
  if (with_images) streams.insert({{channels::kRgbd, {}}, {channels::kFeatures, {}}});
  std::optional<std::int64_t> first_utime;
  while (true) {
    auto event = log->next();
    if (!event) return tl::make_unexpected(event.error());
    if (!event->has_value()) break;
    if (const auto stream = streams.find((*event)->channel); stream != streams.end()) {
      stream->second.bytes += (*event)->bytes.size();
      ++stream->second.messages;
    }
    if ((*event)->channel != channels::kKeyframe) continue;
    const auto keyframe = messages::decode<egraph::Keyframe>((*event)->bytes);
    if (!keyframe) return tl::make_unexpected(keyframe.error());
    if (keyframe->id.value != static_cast<std::int64_t>(robot.announcements.size())) continue;  // announced again
    if (!first_utime) first_utime = keyframe->header.utime;
    robot.announcements.push_back({std::chrono::microseconds(keyframe->header.utime - *first_utime), keyframe->id.value,
                                   std::move((*event)->bytes)});
  }
  for (const auto& [channel, sum] : streams) {
    if (sum.messages > 0) robot.streams.push_back({channel, sum.bytes / sum.messages});
  }
  if (robot.announcements.empty()) return base::fail(path + " holds no keyframes");
  return robot;
}

/// Bytes that have left and reached this thread's machine over eth0.
struct Traffic {
  std::uint64_t received = 0;
  std::uint64_t sent = 0;
};

Traffic traffic() {
  std::ifstream table("/proc/thread-self/net/dev");
  for (std::string line; std::getline(table, line);) {
    const std::size_t colon = line.find("eth0:");
    if (colon == std::string::npos) continue;
    std::istringstream columns(line.substr(colon + 5));
    Traffic result;
    std::uint64_t other = 0;
    columns >> result.received;
    for (int i = 0; i < 7; ++i) columns >> other;
    columns >> result.sent;
    return result;
  }
  return {};
}

std::string prefix_of(int robot) { return std::string("robot").append(std::to_string(robot)).append("_"); }

std::string prefixes(int robots) {
  std::string all = prefix_of(0);
  for (int robot = 1; robot < robots; ++robot) all.append(",").append(prefix_of(robot));
  return all;
}

double percentile(const std::vector<double>& sorted, double fraction) {
  return sorted.empty() ? 0.0 : sorted[static_cast<std::size_t>(fraction * static_cast<double>(sorted.size() - 1))];
}

/// The server's statuses as they come in.
struct ServerUsage {
  messages::ServiceStatus first;
  messages::ServiceStatus last;

  void add(const messages::ServiceStatus& status) {
    if (first.utime == 0) first = status;
    last = status;
  }
  [[nodiscard]] double cores() const {
    return (last.cpu_seconds - first.cpu_seconds) / (1e-6 * static_cast<double>(last.utime - first.utime));
  }
};

class Bench {
 public:
  Bench(const test::Hosts& hosts, const RecordedRobot& recorded) : hosts_(hosts), recorded_(recorded) {}

  void run(int count, std::chrono::seconds duration) {
    hosts_.enter(kServerHost);
    test::Program server("egraph-server", {"--lcm-url", kUrl, "--robots", prefixes(count), "--state",
                                           (folder_.path() / std::to_string(count)).string()});
    hosts_.enter(kRobotsHost);
    const auto bus = transport::LcmBus::create({kUrl, ""}).value();
    ServerUsage usage;
    const auto note_status = [&usage](const transport::ReceivedMessage& message) {
      if (const auto status = messages::decode<messages::ServiceStatus>(message.bytes)) usage.add(*status);
    };
    if (!bus->subscribe(prefix_of(0) + channels::kStatus, note_status, 0)) return spdlog::error("no status");
    std::vector<std::unique_ptr<PlayedRobot>> robots;
    while (usage.first.utime == 0) static_cast<void>(bus->handle(std::chrono::milliseconds(10)));
    const auto start = Clock::now();
    for (int i = 0; i < count; ++i) {
      const auto shift = std::chrono::milliseconds(1000 * i / count);  // they did not all begin at once
      robots.push_back(std::make_unique<PlayedRobot>(*bus, prefix_of(i), recorded_, start + shift));
    }
    const Traffic before = traffic();
    while (Clock::now() < start + duration) {
      for (const auto& robot : robots) robot->step(Clock::now());
      static_cast<void>(bus->handle(std::chrono::milliseconds(1)));
    }
    const Traffic after = traffic();
    const double took = seconds(Clock::now() - start);
    const auto waiting = [&] {
      return std::any_of(robots.begin(), robots.end(), [](const auto& robot) { return robot->unanswered() > 0; });
    };
    while (waiting() && Clock::now() < start + duration + kAnswerLimit) {
      static_cast<void>(bus->handle(std::chrono::milliseconds(1)));
    }
    server.send_signal(SIGINT);
    if (server.wait() != 0) spdlog::error("{}", server.output());
    report(robots, usage, 8e-6 * static_cast<double>(after.sent - before.sent) / took,
           8e-6 * static_cast<double>(after.received - before.received) / took, took);
  }

 private:
  static void report(const std::vector<std::unique_ptr<PlayedRobot>>& robots, const ServerUsage& usage, double up,
                     double down, double took) {
    std::size_t announced = 0, unanswered = 0, repeated = 0;
    std::vector<double> answers;
    for (const auto& robot : robots) {
      announced += robot->announced();
      unanswered += robot->unanswered();
      repeated += robot->repeated();
      answers.insert(answers.end(), robot->answers_ms().begin(), robot->answers_ms().end());
    }
    std::sort(answers.begin(), answers.end());
    spdlog::info(
        "{} robots: {:.1f} keyframes/s, {} of {} answered, {} repeated; answer after {:.1f} ms, 95th {:.1f}, 99th "
        "{:.1f}; "
        "server {:.1f} % of a core, {} MB; {:.1f} Mbit/s from the robots, {:.2f} Mbit/s to them",
        robots.size(), static_cast<double>(announced) / took, announced - unanswered, announced, repeated,
        percentile(answers, 0.5), percentile(answers, 0.95), percentile(answers, 0.99), 100.0 * usage.cores(),
        usage.last.peak_memory_bytes / 1'000'000, up, down);
  }

  const test::Hosts& hosts_;
  const RecordedRobot& recorded_;
  test::TemporaryFolder folder_;
};

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> given(argv + 1, argv + argc);
  if (given.size() < 4 || (given[1] != "graph" && given[1] != "all")) {
    spdlog::error("usage: bench_robots LOG graph|all SECONDS ROBOTS [ROBOTS ...]");
    return 2;
  }
  const auto recorded = read_recording(given[0], given[1] == "all");
  if (!recorded) {
    spdlog::error("{}", recorded.error().message);
    return 1;
  }
  spdlog::info("{} keyframes in {:.1f} s", recorded->announcements.size(),
               seconds(recorded->announcements.back().when));
  const auto hosts = test::Hosts::make(2);
  if (!hosts) {
    spdlog::error("{}", hosts.error().message);
    return 1;
  }
  Bench bench(**hosts, *recorded);
  for (std::size_t i = 3; i < given.size(); ++i)
    bench.run(std::stoi(given[i]), std::chrono::seconds(std::stoi(given[2])));
}
