#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/transport/bus.hpp"
#include "common/transport/channel_prefix.hpp"
#include "common/transport/event_log.hpp"

namespace eg::transport {

/// Replays an LCM log file: every message in order, none lost, as fast as its handlers are; nobody else hears it. What
/// is published goes into a second log, if there is one, at the time of the message being handled.
class LogBus : public Bus {
 public:
  struct Options {
    std::filesystem::path input;
    std::string channel_prefix;                   ///< hears only channels that begin with it
    std::optional<std::filesystem::path> output;  ///< nothing: publish() is an error
  };

  static base::Result<std::unique_ptr<LogBus>> open(const Options& options);

  base::Status publish(std::string_view channel, std::span<const std::uint8_t> bytes) override;

  /// A log does not run ahead of its reader: no queue is needed, and `queue_capacity` has no effect.
  base::Status subscribe(const std::string& channel, Handler handler, int queue_capacity) override;

  /// Runs the handlers of the next message that has any. An error at the end of the log (see ended()) or where it is
  /// damaged.
  base::Result<int> handle(std::chrono::milliseconds timeout) override;

  /// Whether all messages have been handled.
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  struct Subscription {
    std::string name;  // with prefix
    Handler handler;
  };

  LogBus(EventLogReader reader, const Options& options)
      : reader_(std::move(reader)), path_(options.input), prefix_(options.channel_prefix) {}

  int dispatch(const LogEvent& event);

  EventLogReader reader_;
  std::optional<EventLogWriter> writer_;
  std::filesystem::path path_;
  ChannelPrefix prefix_;
  std::deque<Subscription> subscriptions_;  // a handler may subscribe: references stay valid
  std::int64_t utime_ = 0;
  bool ended_ = false;
};

}  // namespace eg::transport
