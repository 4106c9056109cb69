#include "services/viewer/health_view.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "common/messages/service_state.hpp"
#include "services/viewer/packet.hpp"

namespace eg::services {
namespace {

constexpr std::size_t kMaxServices = 64;
constexpr std::size_t kRecent = 6;                    ///< statuses: rates are over five seconds
constexpr std::int64_t kSilentAfter = 3'000'000;      ///< microseconds; three statuses are missing
constexpr std::int64_t kForgottenAfter = 60'000'000;  ///< when there is no room

/// Per second between two statuses of one process.
double rate(double earlier, double later, std::int64_t earlier_utime, std::int64_t later_utime) {
  const double seconds = 1e-6 * static_cast<double>(later_utime - earlier_utime);
  return seconds > 0.0 ? (later - earlier) / seconds : 0.0;
}

std::string to_json(const std::deque<messages::ServiceStatus>& recent, std::int64_t silent_for) {
  const messages::ServiceStatus& then = recent.front();
  const messages::ServiceStatus& now = recent.back();
  const bool silent = silent_for > kSilentAfter && now.state != messages::kEndedState;
  const bool quiet = silent || now.state == messages::kEndedState;
  const double frames = rate(static_cast<double>(then.frames), static_cast<double>(now.frames), then.utime, now.utime);
  const double cpu = rate(then.cpu_seconds, now.cpu_seconds, then.utime, now.utime);
  return fmt::format(
      R"({{"service":{},"host":{},"pid":{},"state":{},"silent":{},"silent_for":{:.1f},"frames":{},"rate":{:.2f},)"
      R"("dropped":{},"rejected":{},"last_rejection":{},"p50":{:.3f},"p90":{:.3f},"p99":{:.3f},"max":{:.3f},)"
      R"("cpu":{:.4f},"memory":{}}})",
      json_string(now.service), json_string(now.host), now.pid, json_string(now.state), silent,
      1e-6 * static_cast<double>(silent_for), now.frames, quiet ? 0.0 : frames, now.dropped, now.rejected,
      json_string(now.last_rejection), now.latency_p50_ms, now.latency_p90_ms, now.latency_p99_ms, now.latency_max_ms,
      quiet ? 0.0 : cpu, now.peak_memory_bytes);
}

}  // namespace

bool HealthView::add(const messages::ServiceStatus& status, std::int64_t now_utime) {
  const std::string key = status.service + '\n' + status.host;
  if (!services_.contains(key) && services_.size() >= kMaxServices) {
    std::erase_if(services_, [&](const auto& item) { return now_utime - item.second.heard_utime > kForgottenAfter; });
    if (services_.size() >= kMaxServices) return false;
  }
  Service& service = services_[key];
  service.heard_utime = now_utime;
  const bool other_process = !service.recent.empty() && service.recent.back().pid != status.pid;
  const bool from_the_past = !service.recent.empty() && service.recent.back().utime > status.utime;  // a replay
  if (other_process || from_the_past) service.recent.clear();
  service.recent.push_back(status);
  if (service.recent.size() > kRecent) service.recent.pop_front();
  return other_process;
}

std::vector<std::uint8_t> HealthView::packet(std::int64_t now_utime, std::int64_t silence) const {
  std::string rows;
  for (const auto& [key, service] : services_) {
    rows.append(rows.empty() ? "" : ",").append(to_json(service.recent, now_utime - service.heard_utime));
  }
  const std::string json = fmt::format("[{}]", rows);
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(json.data()), json.size());
  return Packet("health").set("silence", 1e-6 * static_cast<double>(silence)).array("json", bytes).bytes();
}

}  // namespace eg::services
