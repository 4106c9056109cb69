#include <array>
#include <cerrno>
#include <cstring>

#include "common/transport/channel_prefix.hpp"
#include "common/transport/event_log.hpp"
#include "common/transport/event_log_format.hpp"

namespace eg::transport {
namespace {

std::string reason() { return errno != 0 ? std::string(": ") + std::strerror(errno) : std::string(); }

}  // namespace

base::Result<EventLogWriter> EventLogWriter::create(const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file) return base::fail("cannot write the log " + path.string() + reason());
  return EventLogWriter(std::move(file), path);
}

base::Result<EventLogWriter> EventLogWriter::append(const std::filesystem::path& path, std::uint64_t size,
                                                    std::int64_t events) {
  std::error_code error;
  std::filesystem::resize_file(path, size, error);
  if (error) return base::fail("cannot write the log " + path.string() + ": " + error.message());
  std::ofstream file(path, std::ios::binary | std::ios::app);
  if (!file) return base::fail("cannot write the log " + path.string() + reason());
  EventLogWriter writer(std::move(file), path);
  writer.events_written_ = events;
  writer.size_ = size;
  return writer;
}

base::Status EventLogWriter::write(std::string_view channel, std::span<const std::uint8_t> bytes, std::int64_t utime) {
  if (channel.empty() || channel.size() > kMaxChannelLength || bytes.size() > kMaxMessageBytes) {
    return base::fail("a message of " + std::to_string(bytes.size()) + " bytes on channel '" + std::string(channel) +
                      "' does not fit into a log");
  }
  std::array<char, kEventHeaderBytes> header{};
  char* field = write_big_endian<4>(kSyncWord, header.data());
  field = write_big_endian<8>(static_cast<std::uint64_t>(events_written_), field);
  field = write_big_endian<8>(static_cast<std::uint64_t>(utime), field);
  field = write_big_endian<4>(channel.size(), field);
  write_big_endian<4>(bytes.size(), field);
  file_.write(header.data(), kEventHeaderBytes);
  file_.write(channel.data(), static_cast<std::streamsize>(channel.size()));
  file_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file_) return base::fail("cannot write the log " + path_.string() + reason());
  ++events_written_;
  size_ += kEventHeaderBytes + channel.size() + bytes.size();
  return {};
}

base::Status EventLogWriter::flush() {
  if (!file_.flush()) return base::fail("cannot write the log " + path_.string() + reason());
  return {};
}

}  // namespace eg::transport
