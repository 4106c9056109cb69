#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "common/messages/channels.hpp"
#include "common/messages/service_state.hpp"
#include "services/doctor/live_view.hpp"

namespace eg::doctor {
namespace {

using recording::ChannelStatistics;

constexpr double kTolerableSkewMs =
    50.0;                              // a frame and a half: below it, latencies of other hosts still mean something
constexpr double kSilentAfterS = 3.0;  // STATUS comes once a second

/// FEATURES and POSE carry the numbers of their frames: where a service leaves frames out, numbers are missing.
bool shows_frames_left_out(const std::string& name, const std::map<std::string, ServiceView>& services) {
  const auto leaves_out = [](const auto& service) {
    return service.second.latest.dropped > service.second.first.dropped;
  };
  return (name == messages::channels::kFeatures || name == messages::channels::kPose) &&
         std::any_of(services.begin(), services.end(), leaves_out);
}

void judge_stream(const std::string& name, const ChannelStatistics& channel, bool has_gaps_of_its_own,
                  Findings& findings) {
  if (channel.rejected > 0) {
    findings.push_back({Severity::error,
                        fmt::format("{} of {} messages on {} are refused: {}", channel.rejected, channel.messages, name,
                                    channel.last_rejection),
                        "install the same version of egraph on all machines, and keep strangers off this port"});
  } else if (!channel.type.ends_with("_t")) {
    findings.push_back({Severity::error, fmt::format("{} carries messages of another type ({})", name, channel.type),
                        "install the same version of egraph on all machines, or choose a --channel-prefix"});
  }
  if (channel.missing() > 0 && !has_gaps_of_its_own) {
    const auto sent = channel.missing() + channel.messages - channel.repeated();
    findings.push_back({Severity::warning,
                        fmt::format("{} of {} messages on {} did not arrive here", channel.missing(), sent, name),
                        "sysctl -w net.core.rmem_max=8388608, and recv_buf_size=8388608 in --lcm-url"});
  }
}

void judge_service(const std::string& name, const ServiceView& view, std::int64_t now_utime, Findings& findings) {
  const double skew_ms = 1e-3 * static_cast<double>(view.least_offset);
  if (std::abs(skew_ms) > kTolerableSkewMs) {
    findings.push_back({Severity::warning,
                        fmt::format("the clock of {} is {:.0f} ms {} this machine's", view.latest.host,
                                    std::abs(skew_ms), skew_ms > 0.0 ? "behind" : "ahead of"),
                        "timedatectl set-ntp true (on both machines)"});
  }
  const double silent_s = 1e-6 * static_cast<double>(now_utime - view.last_receive_utime);
  if (silent_s > kSilentAfterS && view.latest.state != messages::kEndedState) {
    findings.push_back(
        {Severity::error, fmt::format("{} has been silent for {:.0f} s", name, silent_s),
         fmt::format("look at its output and start it again; on {}: kill -9 {}", view.latest.host, view.latest.pid)});
  }
  if (const auto count = view.latest.rejected - view.first.rejected; count > 0) {
    findings.push_back({Severity::error,
                        fmt::format("{} refused {} messages: {}", name, count, view.latest.last_rejection),
                        "install the same version of egraph on all machines"});
  }
  if (const auto count = view.latest.dropped - view.first.dropped; count > 0) {
    findings.push_back(
        {Severity::warning, fmt::format("{} missed {} frames while we listened", name, count),
         "start a second egraph-feature-extractor, move services to another machine, or use --lockstep"});
  }
}

/// Extractors may stand side by side; of the others, and of mappers of one share of the space, one is right.
void judge_rivals(const std::map<std::string, ServiceView>& services, Findings& findings) {
  std::map<std::string, int> processes;
  for (const auto& [name, view] : services) ++processes[view.latest.service];
  for (const auto& [service, count] : processes) {
    if (count == 1 || service == "feature_extractor") continue;
    findings.push_back({Severity::warning, fmt::format("{} processes call themselves {}", count, service),
                        "stop all but one, or give each robot a --channel-prefix of its own"});
  }
}

}  // namespace

Findings LiveView::judge(std::int64_t now_utime) const {
  Findings findings;
  if (streams_.channels().empty()) {
    return {{Severity::good, "nobody sends anything of E-Graph SLAM here at the moment", ""}};
  }
  for (const auto& [name, channel] : streams_.channels()) {
    judge_stream(name, channel, shows_frames_left_out(name, services_), findings);
  }
  for (const auto& [name, view] : services_) judge_service(name, view, now_utime, findings);
  judge_rivals(services_, findings);
  return findings;
}

std::string LiveView::format() const {
  std::string text;
  if (streams_.channels().empty()) return text;
  text +=
      fmt::format("\n{:<18} {:>8} {:>10} {:>9} {:>8} {:>8}\n", "stream", "per s", "kB/s", "max kB", "missing", "again");
  for (const auto& [name, channel] : streams_.channels()) {
    const double kilobytes_per_s =
        channel.seconds() > 0.0 ? 1e-3 * static_cast<double>(channel.bytes) / channel.seconds() : 0.0;
    text += fmt::format("{:<18} {:>8.1f} {:>10.1f} {:>9.1f} {:>8} {:>8}\n", name, channel.rate(), kilobytes_per_s,
                        1e-3 * static_cast<double>(channel.largest), channel.missing(), channel.repeated());
  }
  if (!steps_.empty()) {
    text += fmt::format("\n{:<28} {:>8} {:>8} {:>8} {:>8}\n", "step, ms", "p50", "p95", "p99", "max");
    for (const auto& [name, times] : steps_) {
      text += fmt::format("{:<28} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f}\n", name, times.percentile_ms(0.5),
                          times.percentile_ms(0.95), times.percentile_ms(0.99), times.max_ms());
    }
  }
  if (!services_.empty()) {
    text += fmt::format("\n{:<40} {:<16} {:>6} {:>8} {:>8} {:>8} {:>8}\n", "service", "state", "CPU %", "peak MB",
                        "frames", "dropped", "p99 ms");
    for (const auto& [name, view] : services_) {
      text += fmt::format("{:<40} {:<16} {:>6.1f} {:>8.1f} {:>8} {:>8} {:>8.1f}\n", name, view.latest.state,
                          view.cpu_percent(), 1e-6 * static_cast<double>(view.latest.peak_memory_bytes),
                          view.latest.frames, view.latest.dropped, view.latest.latency_p99_ms);
    }
  }
  return text;
}

}  // namespace eg::doctor
