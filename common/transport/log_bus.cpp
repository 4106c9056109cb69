#include "common/transport/log_bus.hpp"

#include <utility>

namespace eg::transport {

base::Result<std::unique_ptr<LogBus>> LogBus::open(const Options& options) {
  auto reader = EventLogReader::open(options.input);
  if (!reader) return tl::make_unexpected(reader.error());
  auto bus = std::unique_ptr<LogBus>(new LogBus(std::move(*reader), options));
  if (options.output) {
    auto writer = EventLogWriter::create(*options.output);
    if (!writer) return tl::make_unexpected(writer.error());
    bus->writer_ = std::move(*writer);
  }
  return bus;
}

base::Status LogBus::publish(std::string_view channel, std::span<const std::uint8_t> bytes) {
  if (!writer_) return base::fail("the log " + path_.string() + " is only read: nothing can be published");
  const auto name = prefix_.add(channel);
  if (!name) return tl::make_unexpected(name.error());
  return writer_->write(*name, bytes, utime_);
}

base::Status LogBus::subscribe(const std::string& channel, Handler handler, int /*queue_capacity*/) {
  auto name = prefix_.add(channel);
  if (!name) return tl::make_unexpected(name.error());
  subscriptions_.push_back({std::move(*name), std::move(handler)});
  return {};
}

base::Result<int> LogBus::handle(std::chrono::milliseconds /*timeout*/) {
  while (!ended_) {
    const auto event = reader_.next();
    if (!event) return tl::make_unexpected(event.error());
    ended_ = !event->has_value();
    if (ended_) break;
    if (const int handled = dispatch(**event); handled > 0) return handled;
  }
  if (writer_) {
    if (const auto flushed = writer_->flush(); !flushed) return tl::make_unexpected(flushed.error());
  }
  return base::fail("the log " + path_.string() + " has ended");
}

int LogBus::dispatch(const LogEvent& event) {
  utime_ = event.utime;
  int handled = 0;
  const std::size_t count = subscriptions_.size();  // a handler may subscribe: that begins with the next message
  for (std::size_t i = 0; i < count; ++i) {
    if (subscriptions_[i].name != event.channel) continue;
    subscriptions_[i].handler({prefix_.remove(event.channel), event.bytes, event.utime});
    ++handled;
  }
  return handled;
}

}  // namespace eg::transport
