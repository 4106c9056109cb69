#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <utility>

#include "common/base/result.hpp"
#include "common/messages/codec.hpp"
#include "common/transport/event_log.hpp"

namespace eg::service {

/// What a service has worked in, on disk, so that one that was killed can go on where it stopped: an LCM log of the
/// messages that its state follows from, each written before anybody hears of what it led to. It survives the process,
/// not a loss of power; egraph-log reads it. io::Journal is the other one: records of any kind with checksums, each on
/// the disk when it is confirmed, for graphs and map archives.
class MessageJournal {
 public:
  using Replay = std::function<base::Status(const transport::LogEvent&)>;

  /// Begins a new journal in place of what is there.
  static base::Result<MessageJournal> create(const std::filesystem::path& path);

  /// Hands everything that is there to `replay` and goes on behind it; without a file as create(). An event that the
  /// process was killed in is cut off. Errors: damage before the end, what `replay` refuses; they name file and byte.
  static base::Result<MessageJournal> resume(const std::filesystem::path& path, const Replay& replay);

  template <typename T>
  base::Status add(const char* channel, const T& value) {
    return add_bytes(channel, messages::encode(value));
  }

  [[nodiscard]] std::uint64_t size() const { return writer_.size(); }  ///< bytes on disk

 private:
  explicit MessageJournal(transport::EventLogWriter writer) : writer_(std::move(writer)) {}

  base::Status add_bytes(const char* channel, const messages::Bytes& bytes);

  transport::EventLogWriter writer_;
};

}  // namespace eg::service
