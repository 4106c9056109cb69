#include "services/doctor/probe.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

namespace eg::doctor {
namespace {

using namespace std::chrono_literals;

constexpr char kChannel[] = "DOCTOR_PROBE";
constexpr int kMessages = 10;
constexpr std::size_t kMessageBytes = 150'000;  // a large RGBD message
constexpr auto kPeriod = 33ms;
constexpr auto kPatience = 500ms;

Finding broken(const base::Error& error) {
  return {Severity::error, error.message, "check that the URL's multicast group and port can be used"};
}

}  // namespace

Finding probe(transport::Bus& bus) {
  const auto received = std::make_shared<int>(0);  // the bus keeps counting what another doctor sends later
  const auto subscribed = bus.subscribe(
      kChannel, [received](const transport::ReceivedMessage&) { ++*received; }, 2 * kMessages);
  if (!subscribed) return broken(subscribed.error());
  const std::vector<std::uint8_t> message(kMessageBytes, 0);
  for (int i = 0; i < kMessages; ++i) {
    if (const auto sent = bus.publish(kChannel, message); !sent) return broken(sent.error());
    if (const auto handled = bus.handle(kPeriod); !handled) return broken(handled.error());
  }
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (*received < kMessages && std::chrono::steady_clock::now() < end) {
    if (const auto handled = bus.handle(kPeriod); !handled) return broken(handled.error());
  }
  const int back = std::min(*received, kMessages);  // another doctor's count, too
  const std::string what =
      fmt::format("{} of {} test messages of {} kB came back", back, kMessages, kMessageBytes / 1000);
  if (back == kMessages) return {Severity::good, what, ""};
  return {back == 0 ? Severity::error : Severity::warning, what,
          "sysctl -w net.core.rmem_max=8388608, and recv_buf_size=8388608 in --lcm-url"};
}

}  // namespace eg::doctor
