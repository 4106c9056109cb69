#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/messages/codec.hpp"
#include "common/transport/memory_bus.hpp"

namespace eg::test {

/// Everything of one type that came over a channel, decoded.
template <typename T>
using Inbox = std::shared_ptr<std::vector<T>>;

/// The rest of the system, as a service under test sees it: sends and collects messages.
class BusPeer {
 public:
  explicit BusPeer(const std::shared_ptr<transport::MemoryNetwork>& network) : bus_(network) {}

  template <typename T>
  Inbox<T> collect(const char* channel) {
    auto inbox = std::make_shared<std::vector<T>>();
    const auto subscribed = bus_.subscribe(
        channel,
        [inbox](const transport::ReceivedMessage& message) {
          auto value = messages::decode<T>(message.bytes);
          ASSERT_TRUE(value.has_value()) << message.channel << ": " << value.error().message;
          inbox->push_back(std::move(*value));
        },
        0);
    EXPECT_TRUE(subscribed.has_value());
    return inbox;
  }

  template <typename T>
  void send(const char* channel, const T& value) {
    EXPECT_TRUE(bus_.publish(channel, messages::encode(value)).has_value());
  }

  void send_bytes(const char* channel, const messages::Bytes& bytes) {
    EXPECT_TRUE(bus_.publish(channel, bytes).has_value());
  }

  /// Handles what waits here; returns how many messages that were.
  int handle() { return bus_.handle(std::chrono::milliseconds(0)).value_or(0); }

 private:
  transport::MemoryBus bus_;
};

}  // namespace eg::test
