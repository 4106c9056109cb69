#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace eg::io {

/// One entry of a journal. What kinds there are and what their bytes mean is the owner's affair.
struct JournalRecord {
  std::uint8_t kind = 0;
  std::string_view bytes;
};

/// What a journal file holds, up to the first record that is not whole.
struct JournalContents {
  std::vector<JournalRecord> records;  ///< their bytes point into the file's
  std::size_t sound_bytes = 0;         ///< of the file, up to the end of the last record
  std::string damage;                  ///< what is wrong behind it, in a few words; empty: nothing
};

/// A journal as bytes: a header with the format's version and the owner's `schema` number, then records, each with its
/// length and a checksum (CRC-32C), so that a write that was cut short and bits that turned over are found.
std::string format_journal(std::uint64_t schema, std::span<const JournalRecord> records);

/// Refuses what is no journal, and journals of another format version or schema. A damaged record ends the contents.
base::Result<JournalContents> parse_journal(std::string_view bytes, std::uint64_t schema);

/// The same for the beginning of a file: whether parse_journal() would take it, whatever its records are.
base::Status check_journal(const std::filesystem::path& path, std::uint64_t schema);

/// Reads a journal that shall be whole, record by record: `take` gets each in turn and may refuse it. Refuses what
/// parse_journal() refuses, and damage. Errors name the file and the record.
base::Status read_journal(const std::filesystem::path& path, std::uint64_t schema,
                          const std::function<base::Status(const JournalRecord&)>& take);

/// Writes a journal that is too large to be held at once, whole or not at all, in the place of whatever is under
/// `path`: `fill` is called with a function that takes the records one by one. Its error is passed on.
base::Status write_journal(
    const std::filesystem::path& path, std::uint64_t schema,
    const std::function<base::Status(const std::function<void(const JournalRecord&)>& add)>& fill);

/// An append-only file of records. What append() has confirmed survives the process and the machine. (The services' logs
/// of messages, which survive the process only and are ten times larger, are service::MessageJournal.)
class Journal {
 public:
  /// Writes a new journal, whole or not at all, in the place of whatever is under `path`.
  static base::Result<Journal> create(const std::filesystem::path& path, std::uint64_t schema,
                                      std::span<const JournalRecord> records);

  /// Opens a journal that was read before, to go on behind its `sound_bytes`; what follows them is cut off.
  static base::Result<Journal> open(const std::filesystem::path& path, std::size_t sound_bytes);

  Journal(Journal&& other) noexcept;
  Journal& operator=(Journal&& other) noexcept;
  ~Journal();

  /// The record is on the disk when this returns success, and not in the journal when it fails.
  base::Status append(const JournalRecord& record);

  [[nodiscard]] std::size_t size() const { return size_; }  ///< bytes

 private:
  Journal(std::filesystem::path path, int descriptor, std::size_t size);

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::size_t size_ = 0;
};

}  // namespace eg::io
