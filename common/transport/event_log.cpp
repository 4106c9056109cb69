#include "common/transport/event_log.hpp"

#include <array>
#include <cerrno>
#include <cstring>

#include "common/transport/channel_prefix.hpp"

namespace eg::transport {
namespace {

constexpr std::uint32_t kSyncWord = 0xeda1da01;
constexpr std::size_t kHeaderBytes = 4 + 8 + 8 + 4 + 4;  // sync word, number, time, channel length, data length

using Header = std::array<char, kHeaderBytes>;

template <int Size>
std::uint64_t read_big_endian(const char* bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < Size; ++i) value = value << 8U | static_cast<std::uint8_t>(bytes[i]);
  return value;
}

template <int Size>
char* write_big_endian(std::uint64_t value, char* bytes) {
  for (int i = 0; i < Size; ++i) bytes[i] = static_cast<char>(value >> (8 * (Size - 1 - i)));
  return bytes + Size;
}

std::string reason() { return errno != 0 ? std::string(": ") + std::strerror(errno) : std::string(); }

}  // namespace

base::Result<EventLogReader> EventLogReader::open(const std::filesystem::path& path) {
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  if (error) return base::fail("cannot read the log " + path.string() + ": " + error.message());
  std::ifstream file(path, std::ios::binary);
  if (!file) return base::fail("cannot open the log " + path.string() + reason());
  return EventLogReader(std::move(file), path, size);
}

base::Result<std::optional<LogEvent>> EventLogReader::next() {
  if (bytes_left_ == 0) return std::nullopt;
  Header header{};
  if (bytes_left_ < kHeaderBytes || !file_.read(header.data(), kHeaderBytes)) {
    return tl::make_unexpected(damaged("ends within an event").error());
  }
  bytes_left_ -= kHeaderBytes;
  const char* field = header.data();
  if (read_big_endian<4>(field) != kSyncWord) return tl::make_unexpected(damaged("is no LCM log").error());
  const std::uint64_t channel_bytes = read_big_endian<4>(field + 20);
  const std::uint64_t data_bytes = read_big_endian<4>(field + 24);
  if (channel_bytes == 0 || channel_bytes > kMaxChannelLength || data_bytes > kMaxMessageBytes) {
    return tl::make_unexpected(damaged("has an event of impossible size").error());
  }
  if (channel_bytes + data_bytes > bytes_left_) return tl::make_unexpected(damaged("ends within an event").error());

  LogEvent event;
  event.utime = static_cast<std::int64_t>(read_big_endian<8>(field + 12));
  event.channel.resize(channel_bytes);
  event.bytes.resize(data_bytes);
  file_.read(event.channel.data(), static_cast<std::streamsize>(channel_bytes));
  file_.read(reinterpret_cast<char*>(event.bytes.data()), static_cast<std::streamsize>(data_bytes));
  if (!file_) return tl::make_unexpected(damaged("cannot be read" + reason()).error());
  bytes_left_ -= channel_bytes + data_bytes;
  ++events_read_;
  return event;
}

base::Status EventLogReader::damaged(const std::string& what) const {
  return base::fail("the log " + path_.string() + " " + what + " (after " + std::to_string(events_read_) + " events)");
}

base::Result<EventLogWriter> EventLogWriter::create(const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file) return base::fail("cannot write the log " + path.string() + reason());
  return EventLogWriter(std::move(file), path);
}

base::Status EventLogWriter::write(std::string_view channel, std::span<const std::uint8_t> bytes, std::int64_t utime) {
  if (channel.empty() || channel.size() > kMaxChannelLength || bytes.size() > kMaxMessageBytes) {
    return base::fail("a message of " + std::to_string(bytes.size()) + " bytes on channel '" + std::string(channel) +
                      "' does not fit into a log");
  }
  Header header{};
  char* field = write_big_endian<4>(kSyncWord, header.data());
  field = write_big_endian<8>(static_cast<std::uint64_t>(events_written_), field);
  field = write_big_endian<8>(static_cast<std::uint64_t>(utime), field);
  field = write_big_endian<4>(channel.size(), field);
  write_big_endian<4>(bytes.size(), field);
  file_.write(header.data(), kHeaderBytes);
  file_.write(channel.data(), static_cast<std::streamsize>(channel.size()));
  file_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file_) return base::fail("cannot write the log " + path_.string() + reason());
  ++events_written_;
  return {};
}

base::Status EventLogWriter::flush() {
  if (!file_.flush()) return base::fail("cannot write the log " + path_.string() + reason());
  return {};
}

}  // namespace eg::transport
