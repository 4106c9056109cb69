#include "services/log/log_summary.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/base/printable.hpp"
#include "common/transport/event_log.hpp"

namespace eg::log_tool {
namespace {

using recording::ChannelStatistics;

double mean_kilobytes(const ChannelStatistics& channel) {
  return 1e-3 * static_cast<double>(channel.bytes) / static_cast<double>(channel.messages);
}

std::string sessions_of(const ChannelStatistics& channel) {
  std::string text;
  for (const auto& [session, statistics] : channel.sessions) {
    if (!text.empty()) text += ',';
    text += std::to_string(session);
  }
  return text.empty() ? "-" : text;
}

/// Seconds from the first to the last message of all.
double duration(const LogSummary& summary) {
  std::int64_t first = INT64_MAX;
  std::int64_t last = 0;
  for (const auto& [name, channel] : summary.streams.channels()) {
    first = std::min(first, channel.first_utime);
    last = std::max(last, channel.last_utime);
  }
  return last > first ? 1e-6 * (static_cast<double>(last) - static_cast<double>(first)) : 0.0;
}

}  // namespace

base::Result<LogSummary> summarise(const std::filesystem::path& file) {
  auto reader = transport::EventLogReader::open(file);
  if (!reader) return tl::make_unexpected(reader.error());
  LogSummary summary;
  summary.file_bytes = std::filesystem::file_size(file);
  for (;;) {
    const auto event = reader->next();
    if (!event) {
      ++summary.damaged_places;
      if (summary.first_damage.empty()) summary.first_damage = event.error().message;
      summary.unread_bytes += reader->recover();
      continue;
    }
    if (!*event) return summary;
    ++summary.events;
    summary.streams.add((*event)->channel, (*event)->bytes, (*event)->utime);
  }
}

std::string format_table(const LogSummary& summary) {
  std::string text = fmt::format("{} messages in {:.1f} s, {:.1f} MB\n\n", summary.events, duration(summary),
                                 1e-6 * summary.file_bytes);
  text += fmt::format("{:<24} {:<18} {:>8} {:>8} {:>9} {:>9} {:>8} {:>8} {:>8}  {}\n", "channel", "type", "messages",
                      "per s", "mean kB", "max kB", "missing", "again", "refused", "sessions");
  for (const auto& [name, channel] : summary.streams.channels()) {
    text += fmt::format("{:<24} {:<18} {:>8} {:>8.1f} {:>9.2f} {:>9.2f} {:>8} {:>8} {:>8}  {}\n", base::printable(name),
                        channel.type, channel.messages, channel.rate(), mean_kilobytes(channel),
                        1e-3 * static_cast<double>(channel.largest), channel.missing(), channel.repeated(),
                        channel.rejected, sessions_of(channel));
    if (channel.rejected > 0) text += fmt::format("  last refusal: {}\n", channel.last_rejection);
  }
  if (summary.damaged_places > 0) {
    text += fmt::format("\ndamaged: {} bytes at {} places could not be read; the first: {}\n", summary.unread_bytes,
                        summary.damaged_places, summary.first_damage);
  }
  return text;
}

std::string format_json(const LogSummary& summary) {
  nlohmann::ordered_json json = {{"file_bytes", summary.file_bytes},
                                 {"messages", summary.events},
                                 {"seconds", duration(summary)},
                                 {"damaged_places", summary.damaged_places},
                                 {"unread_bytes", summary.unread_bytes},
                                 {"first_damage", summary.first_damage},
                                 {"channels", nlohmann::ordered_json::object()}};
  for (const auto& [name, channel] : summary.streams.channels()) {
    auto& entry = json["channels"][name];
    entry = {{"type", channel.type},
             {"messages", channel.messages},
             {"bytes", channel.bytes},
             {"largest", channel.largest},
             {"per_second", channel.rate()},
             {"missing", channel.missing()},
             {"again", channel.repeated()},
             {"refused", channel.rejected},
             {"last_refusal", channel.last_rejection},
             {"sessions", nlohmann::ordered_json::array()}};
    for (const auto& [session, statistics] : channel.sessions) entry["sessions"].push_back(session);
  }
  // A channel's name is any bytes: what is no UTF-8 is replaced.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace eg::log_tool
