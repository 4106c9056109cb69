#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/recording/stream_statistics.hpp"

namespace eg::log_tool {

/// What an LCM log holds.
struct LogSummary {
  std::uint64_t file_bytes = 0;
  std::int64_t events = 0;
  std::int64_t damaged_places = 0;
  std::uint64_t unread_bytes = 0;
  std::string first_damage;  ///< one sentence with its byte offset; empty: none
  recording::StreamStatistics streams;
};

/// Reads the log through; damage is passed over and counted. An error only if it cannot be opened.
base::Result<LogSummary> summarise(const std::filesystem::path& file);

/// A table for a person: one line per channel.
std::string format_table(const LogSummary& summary);

std::string format_json(const LogSummary& summary);

}  // namespace eg::log_tool
