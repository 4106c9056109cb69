#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "common/messages/inspect.hpp"

namespace eg::recording {

/// The numbered messages of one session on one channel.
struct SessionStatistics {
  std::set<std::int64_t> numbers;  ///< seen
  std::int64_t repeated = 0;       ///< messages whose number was there before: sent again

  /// Between the first and the last number seen.
  [[nodiscard]] std::int64_t missing() const;
};

/// What went over one channel.
struct ChannelStatistics {
  std::string type;  ///< of its messages; "mixed" if they differ
  std::int64_t messages = 0;
  std::uint64_t bytes = 0;
  std::uint64_t largest = 0;  ///< bytes
  std::int64_t rejected = 0;  ///< messages that decode() refuses
  std::string last_rejection;
  std::int64_t first_utime = 0;  ///< when received, microseconds
  std::int64_t last_utime = 0;
  std::map<std::int64_t, SessionStatistics> sessions;

  /// From the first message to the last. Times in a damaged log may lie further apart than their difference can say.
  [[nodiscard]] double seconds() const {
    return 1e-6 * (static_cast<double>(last_utime) - static_cast<double>(first_utime));
  }
  /// Messages per second between the first and the last; 0 of fewer than two.
  [[nodiscard]] double rate() const;
  [[nodiscard]] std::int64_t missing() const;
  [[nodiscard]] std::int64_t repeated() const;
};

/// Counts messages by channel: what a log holds, or what is on the air.
class StreamStatistics {
 public:
  /// Returns what is known of the message.
  messages::MessageInfo add(std::string_view channel, messages::ByteView bytes, std::int64_t receive_utime);

  [[nodiscard]] const std::map<std::string, ChannelStatistics>& channels() const { return channels_; }

 private:
  std::map<std::string, ChannelStatistics> channels_;
};

}  // namespace eg::recording
