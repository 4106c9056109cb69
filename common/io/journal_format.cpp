#include "common/io/journal_format.hpp"

#include <cstdint>
#include <string>

#include "common/io/crc.hpp"

namespace eg::io {
namespace {

constexpr std::string_view kMagic = "EGRAPHJ";
constexpr char kFormatVersion = 1;

template <typename Unsigned>
void put(std::string& bytes, Unsigned value) {
  for (std::size_t i = 0; i < sizeof(value); ++i) bytes.push_back(static_cast<char>(value >> (8U * i)));
}

template <typename Unsigned>
Unsigned get(std::string_view bytes) {
  Unsigned value = 0;
  for (std::size_t i = sizeof(value); i-- > 0;) value = (value << 8U) | static_cast<unsigned char>(bytes[i]);
  return value;
}

/// Of length, kind and bytes: a wrong length would be taken for the next record's.
std::uint32_t checksum_of(const JournalRecord& record) {
  std::string head;
  put(head, static_cast<std::uint32_t>(record.bytes.size()));
  head.push_back(static_cast<char>(record.kind));
  return crc32<kCrcCastagnoli>(record.bytes, crc32<kCrcCastagnoli>(head));
}

std::string header(std::uint64_t schema) {
  std::string bytes(kMagic);
  bytes.push_back(kFormatVersion);
  put(bytes, schema);
  return bytes;
}

base::Status check_header(std::string_view bytes, std::uint64_t schema) {
  if (bytes.size() < kJournalHeaderBytes || !bytes.starts_with(kMagic))
    return base::fail("is no journal of E-Graph SLAM");
  const int version = static_cast<unsigned char>(bytes[kMagic.size()]);
  if (version != kFormatVersion) {
    return base::fail("is a journal of format version " + std::to_string(version) + ", not " +
                      std::to_string(kFormatVersion));
  }
  if (get<std::uint64_t>(bytes.substr(kMagic.size() + 1)) != schema) {
    return base::fail("was written by a version of this program with other message types");
  }
  return {};
}

}  // namespace

std::string format_journal_record(const JournalRecord& record) {
  std::string bytes;
  bytes.reserve(kRecordHeaderBytes + record.bytes.size());
  put(bytes, static_cast<std::uint32_t>(record.bytes.size()));
  put(bytes, checksum_of(record));
  bytes.push_back(static_cast<char>(record.kind));
  bytes.append(record.bytes);
  return bytes;
}

RecordHeader parse_record_header(std::string_view bytes) {
  return {get<std::uint32_t>(bytes), get<std::uint32_t>(bytes.substr(4)), static_cast<std::uint8_t>(bytes[8])};
}

bool is_sound(const RecordHeader& head, std::string_view bytes) {
  return checksum_of({head.kind, bytes}) == head.checksum;
}

std::string format_journal(std::uint64_t schema, std::span<const JournalRecord> records) {
  std::string bytes = header(schema);
  for (const JournalRecord& record : records) bytes.append(format_journal_record(record));
  return bytes;
}

base::Result<JournalContents> parse_journal(std::string_view bytes, std::uint64_t schema) {
  if (const auto sound = check_header(bytes, schema); !sound) return tl::make_unexpected(sound.error());
  JournalContents contents;
  contents.sound_bytes = kJournalHeaderBytes;
  while (contents.sound_bytes < bytes.size()) {
    const std::string_view rest = bytes.substr(contents.sound_bytes);
    const std::string name = "record " + std::to_string(contents.records.size());
    if (rest.size() < kRecordHeaderBytes || parse_record_header(rest).length > rest.size() - kRecordHeaderBytes) {
      contents.damage = name + " is cut short";
      break;
    }
    const RecordHeader head = parse_record_header(rest);
    const JournalRecord record{head.kind, rest.substr(kRecordHeaderBytes, head.length)};
    if (!is_sound(head, record.bytes)) {
      contents.damage = name + " has a wrong checksum";
      break;
    }
    contents.records.push_back(record);
    contents.sound_bytes += kRecordHeaderBytes + head.length;
  }
  return contents;
}

}  // namespace eg::io
