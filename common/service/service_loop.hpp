#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "common/service/service.hpp"

namespace eg::service {

/// Drives one service on a bus: messages, idle(), Control requests and the 1 Hz status.
class ServiceLoop {
 public:
  ServiceLoop(transport::Bus& bus, ServiceContext& context, Service& service);

  /// Waits at most `timeout` for messages and handles what has come. An error: the bus has ended. What the service
  /// throws comes out here.
  base::Status step(std::chrono::milliseconds timeout);

  /// True after Control::shutdown, or when the service is finished().
  [[nodiscard]] bool ended() const { return shutdown_ || service_.finished(); }

  /// Saves unless nothing has come in since the last successful save.
  base::Status save();

  /// Sends a last status that says so, for those who would otherwise wonder about the silence.
  void say_goodbye();

 private:
  void handle_control(const messages::Control& control);
  void carry_out_requests();
  void publish_status();

  transport::Bus& bus_;
  ServiceContext& context_;
  Service& service_;
  std::deque<messages::Control> requests_;       ///< to be carried out after the handlers have returned
  std::deque<messages::ControlReply> answered_;  ///< the latest replies, for repeated requests
  std::chrono::steady_clock::time_point next_status_;
  std::int64_t reported_rejections_ = 0;
  int control_messages_ = 0;  ///< of this step
  bool saved_ = false;
  bool shutdown_ = false;
};

}  // namespace eg::service
