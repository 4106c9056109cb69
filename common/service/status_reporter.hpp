#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "common/messages/control.hpp"
#include "common/service/latency_histogram.hpp"

namespace eg::service {

/// Counts what a service does and makes its ServiceStatus.
class StatusReporter {
 public:
  explicit StatusReporter(std::string service_name);

  /// One frame or message was processed in `latency_ms`.
  void count_frame(double latency_ms);
  /// `sequence` of the stream came in; a jump forward counts the missing ones as dropped. A new session counts afresh.
  void count_sequence(std::int64_t session, std::int64_t sequence);
  /// Frames that were given up.
  void count_dropped(std::int64_t frames) { status_.dropped += frames; }
  /// A message failed validation.
  void count_rejected(const std::string& why);
  void set_state(std::string state);
  void set_service(std::string name) { status_.service = std::move(name); }

  /// The status now; utime from the caller, CPU and memory from the operating system.
  [[nodiscard]] messages::ServiceStatus status(std::int64_t utime) const;

 private:
  messages::ServiceStatus status_;
  LatencyHistogram latencies_;
  std::int64_t session_ = 0;
  std::int64_t next_sequence_ = -1;
};

}  // namespace eg::service
