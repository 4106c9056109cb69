#pragma once

#include <string>
#include <vector>

#include "common/transport/bus.hpp"

namespace eg::transport {

/// Notes the messages that a bus hands out.
class Recorder {
 public:
  [[nodiscard]] Bus::Handler handler() {
    return [this](const ReceivedMessage& message) {
      channels.emplace_back(message.channel);
      texts.emplace_back(message.bytes.begin(), message.bytes.end());
      utimes.push_back(message.receive_utime);
    };
  }

  std::vector<std::string> channels;
  std::vector<std::string> texts;
  std::vector<std::int64_t> utimes;
};

inline std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace eg::transport
