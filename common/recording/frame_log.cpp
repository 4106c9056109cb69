#include "common/recording/frame_log.hpp"

#include <map>
#include <set>
#include <string_view>

#include "common/messages/channels.hpp"

namespace eg::recording {
namespace {

/// One sender of frames in a log.
struct Stream {
  struct Frame {
    image::FrameHeader header;
    std::uint64_t offset = 0;
  };

  std::map<std::int64_t, Frame> frames;  ///< by sequence; of repeated ones the first
  geometry::CameraModel camera;          ///< of the first frame read
};

using StreamName = std::pair<std::string, std::int64_t>;  ///< channel and session

/// Everything of interest that one pass over a log finds.
struct Contents {
  std::map<StreamName, Stream> streams;
  std::map<StreamName, std::vector<std::int64_t>> skipped_utimes;  ///< by the END_OF_STREAM's channel and session
  LogDamage damage;
};

void note(LogDamage& damage, const std::string& what) {
  if (damage.first.empty()) damage.first = what;
}

void add_frame(Contents& contents, const transport::LogEvent& event) {
  const auto frame = messages::decode<messages::CompressedFrame>(event.bytes);
  if (!frame) {
    ++contents.damage.rejected;
    std::string what = event.channel;
    what += " at byte " + std::to_string(event.offset) + ": " + frame.error().message;
    return note(contents.damage, what);
  }
  Stream& stream = contents.streams[{event.channel, frame->header.session}];
  if (stream.frames.empty()) stream.camera = frame->camera;
  stream.frames.try_emplace(frame->header.sequence, Stream::Frame{frame->header, event.offset});
}

void add_end(Contents& contents, const transport::LogEvent& event) {
  // One that is damaged is repeated, and only names frames that are not in the log anyway.
  if (auto end = messages::decode<messages::EndOfStream>(event.bytes)) {
    contents.skipped_utimes[{event.channel, end->session}] = std::move(end->skipped_utimes);
  }
}

Contents read_through(transport::EventLogReader& reader) {
  Contents contents;
  for (;;) {
    const auto event = reader.next();
    if (!event) {
      ++contents.damage.places;
      note(contents.damage, event.error().message);
      contents.damage.bytes += reader.recover();
      continue;
    }
    if (!*event) return contents;
    const std::string& channel = (*event)->channel;
    if (channel.ends_with(messages::channels::kRgbd)) add_frame(contents, **event);
    if (channel.ends_with(messages::channels::kEndOfStream)) add_end(contents, **event);
  }
}

std::string list(const std::set<StreamName>& names) {
  std::string text;
  for (const auto& [channel, session] : names) {
    text += text.empty() ? "" : ", ";
    text += "session " + std::to_string(session);
    text += " on " + channel;
  }
  return text;
}

/// The stream that is meant, or why that is not clear.
base::Result<StreamName> choose(const Contents& contents, const FrameLog::Options& options, const std::string& log) {
  std::set<StreamName> all;
  std::set<StreamName> fitting;
  for (const auto& [name, stream] : contents.streams) {
    all.insert(name);
    const bool right_channel = options.channel.empty() || name.first == options.channel;
    if (right_channel && name.second == options.session.value_or(name.second)) fitting.insert(name);
  }
  if (fitting.size() == 1) return *fitting.begin();
  if (fitting.size() > 1) return base::fail("the log " + log + " holds frames of " + list(fitting) + ": choose one");
  if (!all.empty()) return base::fail("the log " + log + " holds other frames only: " + list(all));
  const std::string& why = contents.damage.first;
  return base::fail("the log " + log + " holds no colour and depth frames" + (why.empty() ? "" : " (" + why + ")"));
}

/// END_OF_STREAM's channel beside the frames' channel of the same prefix.
std::string end_channel(std::string channel) {
  channel.resize(channel.size() - std::string_view(messages::channels::kRgbd).size());
  return channel + messages::channels::kEndOfStream;
}

}  // namespace

std::string describe(const LogDamage& damage) {
  std::string text = "the log is not whole: " + std::to_string(damage.missing_frames) + " frames are missing, ";
  text += std::to_string(damage.rejected) + " were rejected, and " + std::to_string(damage.bytes) + " bytes at ";
  text += std::to_string(damage.places) + " places could not be read";
  return damage.first.empty() ? text : text + " (the first: " + damage.first + ")";
}

base::Result<FrameLog> FrameLog::open(const std::filesystem::path& path, const Options& options) {
  auto reader = transport::EventLogReader::open(path);
  if (!reader) return tl::make_unexpected(reader.error());
  FrameLog log(std::move(*reader));
  Contents contents = read_through(log.reader_);
  const auto name = choose(contents, options, path.string());
  if (!name) return tl::make_unexpected(name.error());
  const Stream& stream = contents.streams.at(*name);
  for (const auto& [sequence, frame] : stream.frames) {
    log.frames_.push_back(frame.header);
    log.offsets_.push_back(frame.offset);
  }
  log.channel_ = name->first;
  log.camera_ = stream.camera;
  log.skipped_utimes_ = contents.skipped_utimes[{end_channel(name->first), name->second}];
  log.damage_ = contents.damage;
  log.damage_.missing_frames = stream.frames.rbegin()->first + 1 - static_cast<std::int64_t>(stream.frames.size());
  return log;
}

base::Result<messages::CompressedFrame> FrameLog::read(std::size_t index) {
  reader_.seek(offsets_.at(index));
  const auto event = reader_.next();
  if (!event) return tl::make_unexpected(event.error());
  if (!*event) return base::fail("the log became shorter while it was read");
  return messages::decode<messages::CompressedFrame>((*event)->bytes);
}

}  // namespace eg::recording
