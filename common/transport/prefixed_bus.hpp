#pragma once

#include <string>

#include "common/transport/bus.hpp"
#include "common/transport/channel_prefix.hpp"

namespace eg::transport {

/// One of several shares in a bus: it says and hears only channels with its prefix, which comes behind the bus's own.
/// So one connection to the network serves several groups of processes. The bus must outlive it.
class PrefixedBus : public Bus {
 public:
  PrefixedBus(Bus& bus, std::string prefix) : bus_(bus), prefix_(std::move(prefix)) {}

  base::Status publish(std::string_view channel, std::span<const std::uint8_t> bytes) override;
  base::Status subscribe(const std::string& channel, Handler handler, int queue_capacity) override;

  /// Handles messages for all shares in the bus. Returns how many were for this one since it was last asked, whichever
  /// share handled them.
  base::Result<int> handle(std::chrono::milliseconds timeout) override;

 private:
  Bus& bus_;
  ChannelPrefix prefix_;
  int heard_ = 0;
};

}  // namespace eg::transport
