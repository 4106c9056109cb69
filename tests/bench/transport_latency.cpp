// How long messages of the streams' sizes are under way at 30 Hz, from before publish() to the handler: between two
// threads of one machine, and between two network namespaces joined by veth pairs and a bridge. Needs root.
//
//   bench_transport_latency [MESSAGES]
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

#include "common/transport/lcm_bus.hpp"
#include "tests/support/hosts.hpp"

namespace {

using namespace eg;
using Clock = std::chrono::steady_clock;

constexpr char kUrl[] = "udpm://239.255.76.67:7993?ttl=1&recv_buf_size=2097152";
constexpr char kChannel[] = "BENCH";
constexpr std::chrono::microseconds kPeriod{33'333};

struct Stream {
  const char* name;
  std::size_t bytes;
};
constexpr Stream kStreams[] = {{"POSE", 400},     {"KEYFRAME", 6'000},   {"MESH_CHUNK", 30'000},
                               {"RGBD", 115'000}, {"FEATURES", 130'000}, {"180 kB", 180'000}};

std::int64_t now_ns() { return Clock::now().time_since_epoch().count(); }

/// Latencies in milliseconds of the messages that arrived.
std::vector<double> measure(const test::Hosts& hosts, int receiving_host, std::size_t bytes, int messages) {
  std::vector<double> latencies;
  std::atomic<bool> listening = false;
  std::atomic<bool> done = false;
  std::thread receiver([&] {
    hosts.enter(receiving_host);
    const auto bus = transport::LcmBus::create({kUrl, ""}).value();
    const auto subscribed = bus->subscribe(
        kChannel,
        [&](const transport::ReceivedMessage& message) {
          std::int64_t sent = 0;
          std::memcpy(&sent, message.bytes.data(), sizeof sent);
          latencies.push_back(1e-6 * static_cast<double>(now_ns() - sent));
        },
        0);
    listening = subscribed.has_value();
    while (!done) static_cast<void>(bus->handle(std::chrono::milliseconds(50)));
  });
  hosts.enter(0);
  const auto bus = transport::LcmBus::create({kUrl, ""}).value();
  while (!listening) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::vector<std::uint8_t> payload(bytes, 0x55);
  auto next = Clock::now();
  for (int i = 0; i < messages; ++i) {
    std::this_thread::sleep_until(next += kPeriod);
    const std::int64_t sent = now_ns();
    std::memcpy(payload.data(), &sent, sizeof sent);
    if (!bus->publish(kChannel, payload)) spdlog::error("a message could not be sent");
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  done = true;
  receiver.join();
  return latencies;
}

double percentile(std::vector<double>& sorted, double fraction) {
  return sorted.empty() ? 0.0 : sorted[static_cast<std::size_t>(fraction * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

int main(int argc, char** argv) {
  const int messages = argc > 1 ? std::atoi(argv[1]) : 300;
  const auto hosts = test::Hosts::make(2);
  if (!hosts) {
    spdlog::error("{}", hosts.error().message);
    return 1;
  }
  for (const int receiving_host : {0, 1}) {
    for (const Stream& stream : kStreams) {
      std::vector<double> latencies = measure(**hosts, receiving_host, stream.bytes, messages);
      std::sort(latencies.begin(), latencies.end());
      spdlog::info("{}, {} of {} bytes: {} of {} arrived; median {:.2f} ms, 95th {:.2f}, 99th {:.2f}",
                   receiving_host == 0 ? "one machine" : "over veth", stream.name, stream.bytes, latencies.size(),
                   messages, percentile(latencies, 0.5), percentile(latencies, 0.95), percentile(latencies, 0.99));
    }
  }
}
