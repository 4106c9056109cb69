#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace eg::services {

/// When to send recorded frames so that they come as they came from the sensor. The clock starts once every consumer
/// has been heard of, or after ten seconds.
class RealtimePacer {
 public:
  explicit RealtimePacer(const std::vector<std::string>& consumers) : missing_(consumers.begin(), consumers.end()) {}

  void heard_of(const std::string& service) { missing_.erase(service); }

  /// Microseconds until a frame of time `utime` is due, at most 0 if it is. Nothing while consumers are awaited.
  std::optional<std::int64_t> until(std::int64_t utime, std::int64_t now_utime);

 private:
  std::set<std::string> missing_;
  std::optional<std::int64_t> waiting_since_;
  std::optional<std::int64_t> offset_;  ///< of the monotonic clock to the recording's
};

}  // namespace eg::services
