#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/io/journal.hpp"

namespace eg::io {

inline constexpr std::size_t kJournalHeaderBytes = 16;  ///< magic, format version, schema
inline constexpr std::size_t kRecordHeaderBytes = 9;    ///< length, checksum, kind

/// What stands before the bytes of a record.
struct RecordHeader {
  std::uint32_t length = 0;  ///< of the bytes
  std::uint32_t checksum = 0;
  std::uint8_t kind = 0;
};
RecordHeader parse_record_header(std::string_view bytes);

/// Whether a header's checksum is the one of its record.
bool is_sound(const RecordHeader& header, std::string_view bytes);

/// One record as it stands in the file.
std::string format_journal_record(const JournalRecord& record);

}  // namespace eg::io
