#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "common/base/result.hpp"

namespace eg::transport {

/// The longest channel name that LCM carries, prefix included.
inline constexpr std::size_t kMaxChannelLength = 63;

/// The largest message that a bus takes, bytes. Streams stay far below it (docs/messages.md).
inline constexpr std::size_t kMaxMessageBytes = std::size_t{32} << 20U;

/// Puts a bus's prefix before channel names, and takes it off again. Several groups of processes share one network by
/// having different prefixes; none of them hears the others.
class ChannelPrefix {
 public:
  explicit ChannelPrefix(std::string prefix) : prefix_(std::move(prefix)) {}

  /// The name on the network, or an error if it is empty, too long or has other characters than letters, digits and _ .
  /// / -.
  [[nodiscard]] base::Result<std::string> add(std::string_view channel) const;

  /// The channel without prefix. `name` must begin with it.
  [[nodiscard]] std::string_view remove(std::string_view name) const { return name.substr(prefix_.size()); }

  [[nodiscard]] bool matches(std::string_view name) const { return name.starts_with(prefix_); }

 private:
  std::string prefix_;
};

}  // namespace eg::transport
