#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "common/base/result.hpp"

namespace eg::transport {

/// A message as it came from the bus. The bytes are valid during the handler's call only.
struct ReceivedMessage {
  std::string_view channel;  ///< without the bus's prefix
  std::span<const std::uint8_t> bytes;
  std::int64_t receive_utime = 0;  ///< microseconds
};

/// Publish and subscribe on named channels. Implementations: LCM (LcmBus), in memory (MemoryBus), another bus with a
/// prefix (PrefixedBus). A bus is used by one thread.
class Bus {
 public:
  using Handler = std::function<void(const ReceivedMessage&)>;

  virtual ~Bus() = default;

  virtual base::Status publish(std::string_view channel, std::span<const std::uint8_t> bytes) = 0;

  /// Calls `handler` from handle() for every message on `channel`. At most `queue_capacity` messages wait (0: no
  /// bound); then new ones are dropped. Subscriptions last as long as the bus.
  virtual base::Status subscribe(const std::string& channel, Handler handler, int queue_capacity) = 0;

  /// Waits at most `timeout` for messages and runs the handlers of those that are there. Returns how many were handled
  /// (0: none came in time), or an error when the bus has ended (end of a log, network gone). An exception thrown by a
  /// handler comes out here, never through the C library.
  virtual base::Result<int> handle(std::chrono::milliseconds timeout) = 0;
};

}  // namespace eg::transport
