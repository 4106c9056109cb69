#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/service/service.hpp"

namespace eg::run {

using Clock = std::chrono::steady_clock;

/// Watches a run on the bus: how far it is, whether it has come to its end or stands still, how its services are.
class RunMonitor {
 public:
  struct Options {
    bool lockstep = true;
    std::vector<std::string> consumers;  ///< services that acknowledge frames; several may share the work of one
    std::chrono::milliseconds idle_end{
        2000};  ///< real time: without a pose for so long after the end of the stream, it is over
    std::chrono::milliseconds lost_end{15000};  ///< lockstep: the same when acknowledgements have been lost
    std::chrono::milliseconds stall{60000};     ///< without any progress for so long, something hangs
  };

  RunMonitor(service::ServiceContext& context, Options options, Clock::time_point now);

  /// Called after every round of messages.
  void update(Clock::time_point now);

  [[nodiscard]] std::int64_t frames_done() const;  ///< finished by all consumers (lockstep), or tracked (real time)
  [[nodiscard]] std::int64_t frames_skipped() const;
  [[nodiscard]] std::int64_t poses() const { return poses_; }  ///< frames with a pose
  [[nodiscard]] std::int64_t keyframes() const { return keyframes_; }
  [[nodiscard]] std::string tracking_state() const { return tracking_state_; }
  [[nodiscard]] bool finished() const;

  /// One sentence that names the service that keeps the others waiting, if the run stands still.
  [[nodiscard]] std::optional<std::string> stalled() const;

  /// The names under which `service` reports: mapper.0 and mapper.1 if these two share its work, else its own.
  [[nodiscard]] std::set<std::string> names_of(const std::string& service) const;

  /// The latest of each service, by name.
  [[nodiscard]] const std::map<std::string, messages::ServiceStatus>& statuses() const { return statuses_; }

 private:
  /// Something has come of the service `name`. One that shares the work of a consumer is awaited instead of it.
  void hear_of(const std::string& name);
  [[nodiscard]] std::string slowest_consumer() const;
  [[nodiscard]] std::string longest_silent_service() const;

  Options options_;
  Clock::time_point now_;
  Clock::time_point last_progress_;
  std::map<std::string, std::int64_t> acknowledged_;  ///< by consumer, the newest sequence
  std::map<std::string, messages::ServiceStatus> statuses_;
  std::map<std::string, Clock::time_point> last_heard_;
  std::optional<messages::EndOfStream> end_;
  std::set<std::int64_t> tracked_;  ///< sequences the tracker has answered
  std::int64_t poses_ = 0;
  std::int64_t keyframes_ = 0;
  std::string tracking_state_ = "starting";
};

}  // namespace eg::run
