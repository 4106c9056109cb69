#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>

#include "common/recording/stream_statistics.hpp"
#include "common/service/latency_histogram.hpp"
#include "common/transport/bus.hpp"
#include "services/doctor/finding.hpp"

namespace eg::doctor {

/// One process, as its STATUS messages show it.
struct ServiceView {
  messages::ServiceStatus first;
  messages::ServiceStatus latest;
  std::int64_t last_receive_utime = 0;
  std::int64_t least_offset = 0;  ///< receive time here minus send time there, microseconds: clock skew plus latency

  /// Share of one core between the first and the latest status, percent.
  [[nodiscard]] double cpu_percent() const;
};

/// What is on the bus while the doctor listens: streams with their rates and gaps, the time that each step takes from
/// the arrival of its input to that of its output, and the services.
class LiveView {
 public:
  /// Subscribes to all channels of the project; the bus must outlive the view.
  explicit LiveView(transport::Bus& bus);

  [[nodiscard]] const recording::StreamStatistics& streams() const { return streams_; }
  [[nodiscard]] const std::map<std::string, service::LatencyHistogram>& steps() const { return steps_; }
  [[nodiscard]] const std::map<std::string, ServiceView>& services() const { return services_; }

  /// What is wrong with all that. `now_utime`: the end of listening, on the receive times' clock.
  [[nodiscard]] Findings judge(std::int64_t now_utime) const;

  /// Tables of streams, steps and services for a person; empty if nothing was heard.
  [[nodiscard]] std::string format() const;

 private:
  void receive(const transport::ReceivedMessage& message);
  void take_step_times(const transport::ReceivedMessage& message, const messages::MessageInfo& info);
  void take_status(const transport::ReceivedMessage& message);

  recording::StreamStatistics streams_;
  std::map<std::string, service::LatencyHistogram> steps_;  ///< by "RGBD to FEATURES" and so on
  std::map<std::string, ServiceView> services_;             ///< by "tracker on host (pid)"
  /// By channel, session and frame time: when the message came.
  std::map<std::tuple<std::string, std::int64_t, std::int64_t>, std::int64_t> arrivals_;
};

}  // namespace eg::doctor
