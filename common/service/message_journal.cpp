#include "common/service/message_journal.hpp"

#include <optional>
#include <string>

namespace eg::service {
namespace {

/// The end of the events that can be read, and how many there are.
struct Extent {
  std::uint64_t bytes = 0;
  std::int64_t events = 0;
};

base::Result<Extent> replay_all(transport::EventLogReader& reader, const std::filesystem::path& path,
                                const MessageJournal::Replay& replay) {
  Extent extent;
  for (;; ++extent.events) {
    extent.bytes = reader.position();
    const auto event = reader.next();
    if (!event) {
      // Half an event at the end is what being killed leaves; whole ones behind it are not.
      reader.recover();
      const auto another = reader.next();
      if (another && another->has_value()) return tl::make_unexpected(event.error());
      return extent;
    }
    if (!event->has_value()) return extent;
    if (const base::Status done = replay(**event); !done) {
      return base::fail(path.string() + ": event at byte " + std::to_string(extent.bytes) + ": " +
                        done.error().message);
    }
  }
}

}  // namespace

base::Result<MessageJournal> MessageJournal::create(const std::filesystem::path& path) {
  auto writer = transport::EventLogWriter::create(path);
  if (!writer) return tl::make_unexpected(writer.error());
  return MessageJournal(std::move(*writer));
}

base::Result<MessageJournal> MessageJournal::resume(const std::filesystem::path& path, const Replay& replay) {
  if (!std::filesystem::exists(path)) return create(path);
  auto reader = transport::EventLogReader::open(path);
  if (!reader) return tl::make_unexpected(reader.error());
  const auto extent = replay_all(*reader, path, replay);
  if (!extent) return tl::make_unexpected(extent.error());
  auto writer = transport::EventLogWriter::append(path, extent->bytes, extent->events);
  if (!writer) return tl::make_unexpected(writer.error());
  return MessageJournal(std::move(*writer));
}

base::Status MessageJournal::add_bytes(const char* channel, const messages::Bytes& bytes) {
  const base::Status written = writer_.write(channel, bytes, 0);
  return written ? writer_.flush() : written;
}

}  // namespace eg::service
