#include "common/io/journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <ostream>
#include <string>
#include <utility>

#include "common/io/atomic_file.hpp"
#include "common/io/journal_format.hpp"
#include "common/io/write_all.hpp"

namespace eg::io {
namespace {

base::Status failed(const std::filesystem::path& path) {
  return base::fail(path.string() + ": cannot be written: " + std::strerror(errno));
}

}  // namespace

base::Status check_journal(const std::filesystem::path& path, std::uint64_t schema) {
  std::ifstream file(path, std::ios::binary);
  std::string head(kJournalHeaderBytes, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  if (file.bad() || !file.is_open()) return base::fail(path.string() + ": cannot be read");
  head.resize(static_cast<std::size_t>(file.gcount()));
  if (const auto sound = parse_journal(head, schema); !sound) {
    return base::fail(path.string() + ": " + sound.error().message);
  }
  return {};
}

base::Status write_journal(const std::filesystem::path& path, std::uint64_t schema,
                           const std::function<base::Status(const std::function<void(const JournalRecord&)>&)>& fill) {
  return write_file_atomically(path, [&](std::ostream& file) -> base::Status {
    file << format_journal(schema, {});
    return fill([&file](const JournalRecord& record) { file << format_journal_record(record); });
  });
}

base::Status read_journal(const std::filesystem::path& path, std::uint64_t schema,
                          const std::function<base::Status(const JournalRecord&)>& take) {
  if (auto sound = check_journal(path, schema); !sound) return sound;
  std::error_code failure;
  std::uintmax_t left = std::filesystem::file_size(path, failure);
  std::ifstream file(path, std::ios::binary);
  file.seekg(kJournalHeaderBytes);
  if (failure || !file.good()) return base::fail(path.string() + ": cannot be read");
  left -= kJournalHeaderBytes;
  std::string bytes;
  const auto read = [&](std::size_t size) {
    if (size > left) return false;
    bytes.resize(size);
    left -= size;
    return file.read(bytes.data(), static_cast<std::streamsize>(size)).good();
  };
  for (int number = 0; left > 0; ++number) {
    const auto about = [&](const std::string& what) {
      return base::fail(path.string() + ": record " + std::to_string(number) + what);
    };
    if (!read(kRecordHeaderBytes)) return about(" is cut short");
    const RecordHeader header = parse_record_header(bytes);
    if (!read(header.length)) return about(" is cut short");
    if (!is_sound(header, bytes)) return about(" has a wrong checksum");
    if (const auto taken = take({header.kind, bytes}); !taken) return about(": " + taken.error().message);
  }
  return {};
}

Journal::Journal(std::filesystem::path path, int descriptor, std::size_t size)
    : path_(std::move(path)), descriptor_(descriptor), size_(size) {}

Journal::Journal(Journal&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

Journal& Journal::operator=(Journal&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(size_, other.size_);
  return *this;
}

Journal::~Journal() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

base::Result<Journal> Journal::create(const std::filesystem::path& path, std::uint64_t schema,
                                      std::span<const JournalRecord> records) {
  const std::string bytes = format_journal(schema, records);
  if (const auto written = write_file_atomically(path, bytes, Durability::machine); !written) {
    return tl::make_unexpected(written.error());
  }
  return open(path, bytes.size());
}

base::Result<Journal> Journal::open(const std::filesystem::path& path, std::size_t sound_bytes) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (descriptor < 0) return tl::make_unexpected(failed(path).error());
  Journal journal(path, descriptor, sound_bytes);
  if (::ftruncate(descriptor, static_cast<off_t>(sound_bytes)) != 0) return tl::make_unexpected(failed(path).error());
  return journal;
}

base::Status Journal::append(const JournalRecord& record) {
  const std::string bytes = format_journal_record(record);
  if (write_all(descriptor_, bytes) && ::fdatasync(descriptor_) == 0) {
    size_ += bytes.size();
    return {};
  }
  const base::Status failure = failed(path_);
  // What was written of it must not stand before the next record; if it cannot be removed, there is no next one.
  if (::ftruncate(descriptor_, static_cast<off_t>(size_)) != 0) ::close(std::exchange(descriptor_, -1));
  return failure;
}

}  // namespace eg::io
