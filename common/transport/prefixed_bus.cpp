#include "common/transport/prefixed_bus.hpp"

#include <utility>

namespace eg::transport {

base::Status PrefixedBus::publish(std::string_view channel, std::span<const std::uint8_t> bytes) {
  const auto name = prefix_.add(channel);
  return name ? bus_.publish(*name, bytes) : tl::make_unexpected(name.error());
}

base::Status PrefixedBus::subscribe(const std::string& channel, Handler handler, int queue_capacity) {
  const auto name = prefix_.add(channel);
  if (!name) return tl::make_unexpected(name.error());
  const auto count_and_handle = [this, handler = std::move(handler)](const ReceivedMessage& message) {
    ++heard_;
    handler({prefix_.remove(message.channel), message.bytes, message.receive_utime});
  };
  return bus_.subscribe(*name, count_and_handle, queue_capacity);
}

base::Result<int> PrefixedBus::handle(std::chrono::milliseconds timeout) {
  const auto handled = bus_.handle(timeout);
  if (!handled) return handled;
  return std::exchange(heard_, 0);
}

}  // namespace eg::transport
