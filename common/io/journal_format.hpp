#pragma once

#include <cstddef>
#include <string>

#include "common/io/journal.hpp"

namespace eg::io {

inline constexpr std::size_t kJournalHeaderBytes = 16;  ///< magic, format version, schema

/// One record as it stands in the file.
std::string format_journal_record(const JournalRecord& record);

}  // namespace eg::io
