#include "common/recording/stream_statistics.hpp"

#include <algorithm>

#include "common/messages/channels.hpp"

namespace eg::recording {
namespace {

/// Whether every number is sent. Features of keyframes are answers to those who lack some: nothing is missing between.
bool is_gapless(std::string_view channel) { return !channel.ends_with(messages::channels::kKeyframeFeatures); }

}  // namespace

std::int64_t SessionStatistics::missing() const {
  if (numbers.empty()) return 0;
  return *numbers.rbegin() - *numbers.begin() + 1 - static_cast<std::int64_t>(numbers.size());
}

double ChannelStatistics::rate() const {
  const double time = seconds();
  return time > 0.0 ? static_cast<double>(messages - 1) / time : 0.0;
}

std::int64_t ChannelStatistics::missing() const {
  std::int64_t sum = 0;
  for (const auto& [session, statistics] : sessions) sum += statistics.missing();
  return sum;
}

std::int64_t ChannelStatistics::repeated() const {
  std::int64_t sum = 0;
  for (const auto& [session, statistics] : sessions) sum += statistics.repeated;
  return sum;
}

messages::MessageInfo StreamStatistics::add(std::string_view channel, messages::ByteView bytes,
                                            std::int64_t receive_utime) {
  messages::MessageInfo info = messages::inspect(bytes);
  ChannelStatistics& statistics = channels_[std::string(channel)];
  if (statistics.messages == 0) {
    statistics.type = info.type;
    statistics.first_utime = statistics.last_utime = receive_utime;
  }
  if (statistics.type != info.type) statistics.type = "mixed";
  ++statistics.messages;
  statistics.bytes += bytes.size();
  statistics.largest = std::max<std::uint64_t>(statistics.largest, bytes.size());
  statistics.first_utime = std::min(statistics.first_utime, receive_utime);
  statistics.last_utime = std::max(statistics.last_utime, receive_utime);
  if (!info.error.empty()) {
    ++statistics.rejected;
    statistics.last_rejection = info.error;
  }
  if (info.session) {
    SessionStatistics& session = statistics.sessions[*info.session];
    if (info.number && is_gapless(channel) && !session.numbers.insert(*info.number).second) ++session.repeated;
  }
  return info;
}

}  // namespace eg::recording
