#pragma once

#include <functional>

#include "common/procman/deputy.hpp"
#include "common/transport/bus.hpp"

namespace eg::procman_deputy {

/// A deputy on a bus. What cannot be decoded is logged and otherwise ignored.
class DeputyService {
 public:
  DeputyService(transport::Bus& bus, procman::Deputy::Options options);

  base::Status subscribe();

  /// Runs until `stop_count` rises above 0, then stops all commands, or kills them when it reaches
  /// procman::kStopAtOnce. Returns the exit code.
  int run(const std::function<int()>& stop_count);

 private:
  base::Status step();
  template <typename Message>
  base::Status subscribe(const char* channel);
  template <typename Message>
  void publish(const char* channel, const Message& message);

  transport::Bus& bus_;
  procman::Deputy deputy_;
};

}  // namespace eg::procman_deputy
