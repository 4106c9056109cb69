#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "common/transport/channel_prefix.hpp"
#include "common/transport/event_log.hpp"
#include "common/transport/event_log_format.hpp"

namespace eg::transport {
namespace {

constexpr std::size_t kSearchBlock = std::size_t{1} << 20U;

}  // namespace

std::uint64_t EventLogReader::Header::event_bytes() const { return kEventHeaderBytes + channel_bytes + data_bytes; }

base::Result<EventLogReader> EventLogReader::open(const std::filesystem::path& path) {
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  if (error) return base::fail("cannot read the log " + path.string() + ": " + error.message());
  auto file = std::make_unique<std::ifstream>(path, std::ios::binary);
  if (!*file) return base::fail("cannot open the log " + path.string() + ": " + std::strerror(errno));
  return EventLogReader(std::move(file), path.string(), size);
}

base::Result<std::optional<LogEvent>> EventLogReader::next() {
  if (position_ >= size_) return std::nullopt;
  const auto header = read_header(position_);
  if (!header) return tl::make_unexpected(header.error());
  LogEvent event;
  event.offset = position_;
  event.utime = header->utime;
  event.channel.resize(header->channel_bytes);
  event.bytes.resize(header->data_bytes);
  const std::uint64_t at = position_ + kEventHeaderBytes;
  if (!read_at(at, event.channel.data(), header->channel_bytes) ||
      !read_at(at + header->channel_bytes, event.bytes.data(), header->data_bytes)) {
    return tl::make_unexpected(damaged(position_, "cannot be read"));
  }
  position_ += header->event_bytes();
  return event;
}

std::uint64_t EventLogReader::recover() {
  const std::uint64_t damage = position_;
  const std::array<char, 4> sync = sync_word_bytes();
  std::vector<char> block(kSearchBlock);
  for (std::uint64_t at = damage + 1; at < size_;) {
    const std::uint64_t count = std::min<std::uint64_t>(block.size(), size_ - at);
    if (!read_at(at, block.data(), count)) break;
    const auto end = block.begin() + static_cast<std::ptrdiff_t>(count);
    for (auto found = block.begin();; ++found) {
      found = std::search(found, end, sync.begin(), sync.end());
      if (found == end) break;
      position_ = at + static_cast<std::uint64_t>(found - block.begin());
      if (is_event(position_)) return position_ - damage;
    }
    if (at + count >= size_) break;
    at += count - (sync.size() - 1);  // a sync word may lie across two blocks
  }
  position_ = size_;
  return size_ - damage;
}

base::Result<EventLogReader::Header> EventLogReader::read_header(std::uint64_t offset) {
  std::array<char, kEventHeaderBytes> bytes{};
  if (size_ - offset < bytes.size()) return tl::make_unexpected(damaged(offset, "ends within an event"));
  if (!read_at(offset, bytes.data(), bytes.size())) return tl::make_unexpected(damaged(offset, "cannot be read"));
  if (read_big_endian<4>(bytes.data()) != kSyncWord) {
    return tl::make_unexpected(damaged(offset, offset == 0 ? "is no LCM log" : "has no event"));
  }
  Header header;
  header.utime = static_cast<std::int64_t>(read_big_endian<8>(bytes.data() + 12));
  header.channel_bytes = read_big_endian<4>(bytes.data() + 20);
  header.data_bytes = read_big_endian<4>(bytes.data() + 24);
  if (header.channel_bytes == 0 || header.channel_bytes > kMaxChannelLength || header.data_bytes > kMaxMessageBytes) {
    return tl::make_unexpected(damaged(offset, "has an event of impossible size"));
  }
  if (header.event_bytes() > size_ - offset) return tl::make_unexpected(damaged(offset, "ends within an event"));
  return header;
}

bool EventLogReader::is_event(std::uint64_t offset) {
  const auto header = read_header(offset);
  if (!header) return false;
  const std::uint64_t next = offset + header->event_bytes();
  std::array<char, 4> sync{};
  if (next == size_) return true;
  return size_ - next >= sync.size() && read_at(next, sync.data(), sync.size()) && sync == sync_word_bytes();
}

bool EventLogReader::read_at(std::uint64_t offset, void* bytes, std::uint64_t count) {
  stream_->clear();
  stream_->seekg(static_cast<std::streamoff>(offset));
  stream_->read(static_cast<char*>(bytes), static_cast<std::streamsize>(count));
  return static_cast<bool>(*stream_);
}

base::Error EventLogReader::damaged(std::uint64_t offset, const std::string& what) const {
  return {"the log " + name_ + " " + what + " (byte " + std::to_string(offset) + ")"};
}

}  // namespace eg::transport
