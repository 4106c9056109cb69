#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "common/base/random.hpp"
#include "common/transport/bus.hpp"
#include "common/transport/channel_prefix.hpp"

namespace eg::transport {

class MemoryBus;

/// What several MemoryBus objects of one thread are attached to. Messages arrive in the order in which they were sent,
/// also at the sender, unless the network is told to disturb them as a datagram network may.
class MemoryNetwork {
 public:
  /// Probabilities per message and receiver, in [0, 1].
  struct Disturbance {
    double loss = 0.0;
    double duplication = 0.0;
    double reordering = 0.0;  ///< the message overtakes the one before it
    std::uint64_t seed = 0;
  };

  MemoryNetwork() : MemoryNetwork(Disturbance{}) {}
  explicit MemoryNetwork(const Disturbance& disturbance);

  /// What later messages carry as receive time, microseconds.
  void set_time(std::int64_t utime) { utime_ = utime; }

 private:
  friend class MemoryBus;

  void deliver(const std::string& name, std::span<const std::uint8_t> bytes);

  Disturbance disturbance_;
  base::Random random_;
  std::int64_t utime_ = 0;
  std::vector<MemoryBus*> buses_;  // in the order in which they were attached
};

/// A bus within one thread, for tests and for running all services in one process. Deterministic; handle() never waits,
/// for nobody else could send meanwhile.
class MemoryBus : public Bus {
 public:
  explicit MemoryBus(std::shared_ptr<MemoryNetwork> network, std::string channel_prefix = {});
  ~MemoryBus() override;
  MemoryBus(const MemoryBus&) = delete;
  MemoryBus& operator=(const MemoryBus&) = delete;

  base::Status publish(std::string_view channel, std::span<const std::uint8_t> bytes) override;
  base::Status subscribe(const std::string& channel, Handler handler, int queue_capacity) override;

  /// Runs the handlers of the messages that are waiting now; what the handlers send waits for the next call.
  base::Result<int> handle(std::chrono::milliseconds timeout) override;

 private:
  friend class MemoryNetwork;

  struct Message {
    std::string name;  // with prefix
    std::vector<std::uint8_t> bytes;
    std::int64_t utime = 0;
  };
  struct Subscription {
    std::string name;  // with prefix
    Handler handler;
    int capacity = 0;
    int waiting = 0;
  };
  struct Delivery {
    std::size_t subscription = 0;
    std::shared_ptr<const Message> message;
  };

  void enqueue(const std::shared_ptr<const Message>& message, bool overtake);

  std::shared_ptr<MemoryNetwork> network_;
  ChannelPrefix prefix_;
  std::deque<Subscription> subscriptions_;  // a handler may subscribe: references stay valid
  std::deque<Delivery> waiting_;
};

}  // namespace eg::transport
