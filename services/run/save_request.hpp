#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "common/service/service.hpp"
#include "services/run/run_monitor.hpp"

namespace eg::run {

/// Asks services to save, again and again until each has answered: datagrams get lost, and a repeated request is
/// answered from memory.
class SaveRequest {
 public:
  /// Subscribes; nothing is asked yet.
  SaveRequest(service::ServiceContext& context, std::int64_t request_id);

  void start(const std::set<std::string>& services, Clock::time_point now);
  /// Repeats the question when it is due.
  void update(Clock::time_point now);
  /// A service that has died will not answer.
  void give_up_on(const std::string& service) { waiting_for_.erase(service); }

  [[nodiscard]] bool done() const { return waiting_for_.empty(); }
  [[nodiscard]] const std::set<std::string>& waiting_for() const { return waiting_for_; }
  /// What could not be saved and why, by service.
  [[nodiscard]] const std::map<std::string, std::string>& failures() const { return failures_; }

 private:
  service::ServiceContext& context_;
  std::int64_t request_id_;
  std::set<std::string> waiting_for_;
  std::map<std::string, std::string> failures_;
  Clock::time_point next_ask_;
};

}  // namespace eg::run
