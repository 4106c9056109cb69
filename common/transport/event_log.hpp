#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <istream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/result.hpp"

namespace eg::transport {

/// One message of a log file.
struct LogEvent {
  std::uint64_t offset = 0;  ///< of its first byte in the file
  std::int64_t utime = 0;    ///< when it was received, microseconds
  std::string channel;       ///< with its prefix
  std::vector<std::uint8_t> bytes;
};

/// Reads the files that lcm-logger writes: per event a sync word, event number, time, two lengths, channel and data,
/// numbers big-endian (LCM's documentation, "Log file format"). Unlike LCM's own reader it never trusts a length, and
/// says where a file is damaged.
class EventLogReader {
 public:
  static base::Result<EventLogReader> open(const std::filesystem::path& path);

  /// Reads from anything that can be sought; `name` stands in error messages.
  EventLogReader(std::unique_ptr<std::istream> stream, std::string name, std::uint64_t size)
      : stream_(std::move(stream)), name_(std::move(name)), size_(size) {}

  /// The next event; nothing at the end of the file; an error that names the byte where the file is damaged or ends
  /// within an event.
  base::Result<std::optional<LogEvent>> next();

  /// After an error: goes to the next place where an event can begin, that is, one that is followed by another or by
  /// the end of the file. Returns how many bytes were passed over.
  std::uint64_t recover();

  /// Where next() reads: the offset of an event.
  void seek(std::uint64_t offset) { position_ = offset; }
  [[nodiscard]] std::uint64_t position() const { return position_; }

 private:
  struct Header {
    std::int64_t utime = 0;
    std::uint64_t channel_bytes = 0;
    std::uint64_t data_bytes = 0;
    [[nodiscard]] std::uint64_t event_bytes() const;
  };

  base::Result<Header> read_header(std::uint64_t offset);
  [[nodiscard]] bool is_event(std::uint64_t offset);
  [[nodiscard]] bool read_at(std::uint64_t offset, void* bytes, std::uint64_t count);
  [[nodiscard]] base::Error damaged(std::uint64_t offset, const std::string& what) const;

  std::unique_ptr<std::istream> stream_;
  std::string name_;
  std::uint64_t size_;
  std::uint64_t position_ = 0;
};

/// Writes such files; lcm-logplayer and LCM's file:// URLs read them.
class EventLogWriter {
 public:
  static base::Result<EventLogWriter> create(const std::filesystem::path& path);

  /// Goes on behind the first `size` bytes of a log, which hold `events` whole events; what follows them is cut off.
  static base::Result<EventLogWriter> append(const std::filesystem::path& path, std::uint64_t size,
                                             std::int64_t events);

  /// @param channel as it is on the network, with its prefix
  base::Status write(std::string_view channel, std::span<const std::uint8_t> bytes, std::int64_t utime);

  /// Brings everything to the file; says whether all of it got there.
  base::Status flush();

  [[nodiscard]] std::uint64_t size() const { return size_; }  ///< bytes of the log

 private:
  EventLogWriter(std::ofstream file, std::filesystem::path path) : file_(std::move(file)), path_(std::move(path)) {}

  std::ofstream file_;
  std::filesystem::path path_;
  std::int64_t events_written_ = 0;
  std::uint64_t size_ = 0;
};

}  // namespace eg::transport
