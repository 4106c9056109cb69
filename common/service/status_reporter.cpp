#include "common/service/status_reporter.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <utility>

namespace eg::service {
namespace {

std::string host_name() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) return "unknown";
  return name.data();
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

StatusReporter::StatusReporter(std::string service_name) {
  status_.service = std::move(service_name);
  status_.host = host_name();
  status_.pid = getpid();
  status_.state = "running";
}

void StatusReporter::count_frame(double latency_ms) {
  ++status_.frames;
  latencies_.add(latency_ms);
}

void StatusReporter::count_sequence(std::int64_t session, std::int64_t sequence) {
  if (next_sequence_ >= 0 && session == session_ && sequence > next_sequence_)
    status_.dropped += sequence - next_sequence_;
  // A late or repeated message does not turn the clock back: what it filled was already counted as dropped.
  if (session != session_ || sequence >= next_sequence_) next_sequence_ = sequence + 1;
  session_ = session;
}

void StatusReporter::count_rejected(const std::string& why) {
  ++status_.rejected;
  status_.last_rejection = why;
}

void StatusReporter::set_state(std::string state) { status_.state = std::move(state); }

messages::ServiceStatus StatusReporter::status(std::int64_t utime) const {
  messages::ServiceStatus status = status_;
  status.utime = utime;
  status.latency_p50_ms = latencies_.percentile_ms(0.5);
  status.latency_p90_ms = latencies_.percentile_ms(0.9);
  status.latency_p99_ms = latencies_.percentile_ms(0.99);
  status.latency_max_ms = latencies_.max_ms();
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) {
    status.cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    status.peak_memory_bytes = static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
  }
  return status;
}

}  // namespace eg::service
