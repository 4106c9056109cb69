#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
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
  std::int64_t utime = 0;  ///< when it was received, microseconds
  std::string channel;     ///< with its prefix
  std::vector<std::uint8_t> bytes;
};

/// Reads the files that lcm-logger writes: per event a sync word, event number, time, two lengths, channel and data,
/// numbers big-endian (LCM's documentation, "Log file format"). Unlike LCM's own reader it never trusts a length, and
/// says where a file is damaged.
class EventLogReader {
 public:
  static base::Result<EventLogReader> open(const std::filesystem::path& path);

  /// The next event; nothing at the end of the file; an error where the file is damaged or ends within an event.
  base::Result<std::optional<LogEvent>> next();

 private:
  EventLogReader(std::ifstream file, std::filesystem::path path, std::uint64_t size)
      : file_(std::move(file)), path_(std::move(path)), bytes_left_(size) {}

  [[nodiscard]] base::Status damaged(const std::string& what) const;

  std::ifstream file_;
  std::filesystem::path path_;
  std::uint64_t bytes_left_;
  std::int64_t events_read_ = 0;
};

/// Writes such files; lcm-logplayer and LCM's file:// URLs read them.
class EventLogWriter {
 public:
  static base::Result<EventLogWriter> create(const std::filesystem::path& path);

  /// @param channel as it is on the network, with its prefix
  base::Status write(std::string_view channel, std::span<const std::uint8_t> bytes, std::int64_t utime);

  /// Brings everything to the file; says whether all of it got there.
  base::Status flush();

 private:
  EventLogWriter(std::ofstream file, std::filesystem::path path) : file_(std::move(file)), path_(std::move(path)) {}

  std::ofstream file_;
  std::filesystem::path path_;
  std::int64_t events_written_ = 0;
};

}  // namespace eg::transport
