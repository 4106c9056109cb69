#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/result.hpp"
#include "common/messages/codec.hpp"
#include "common/transport/event_log.hpp"

namespace eg::recording {

/// What is wrong with a log that can be read all the same.
struct LogDamage {
  std::int64_t places = 0;          ///< where no event could be read
  std::uint64_t bytes = 0;          ///< passed over there
  std::int64_t rejected = 0;        ///< frames that are no valid message
  std::int64_t missing_frames = 0;  ///< by gaps in the sequence numbers
  std::string first;                ///< what is wrong first, with its byte offset; empty: nothing

  [[nodiscard]] bool any() const { return places + rejected + missing_frames > 0; }
};

/// One sentence for a person.
std::string describe(const LogDamage& damage);

/// The colour and depth frames of one session that an LCM log holds, in the order of their sequence numbers and each
/// once, whatever was sent again or overtaken while it was recorded. Frames come out as they were recorded, images
/// still compressed: what is computed from them is what was computed when they were recorded.
class FrameLog {
 public:
  struct Options {
    std::string channel;                  ///< with its prefix; empty: the only one that has frames
    std::optional<std::int64_t> session;  ///< nothing: the only one
  };

  /// Reads the log through once. An error if it holds no frames, or those of several sessions or channels and `options`
  /// do not say which; damage is passed over and counted.
  static base::Result<FrameLog> open(const std::filesystem::path& path, const Options& options);

  [[nodiscard]] const std::vector<image::FrameHeader>& frames() const { return frames_; }
  /// The first frame's.
  [[nodiscard]] const geometry::CameraModel& camera() const { return camera_; }
  [[nodiscard]] std::int64_t session() const { return frames_.front().session; }
  [[nodiscard]] const std::string& channel() const { return channel_; }
  /// Acquisition times (microseconds) of frames that could not be read when the log was recorded.
  [[nodiscard]] const std::vector<std::int64_t>& skipped_utimes() const { return skipped_utimes_; }
  [[nodiscard]] const LogDamage& damage() const { return damage_; }

  /// Frame `index` of frames().
  base::Result<messages::CompressedFrame> read(std::size_t index);

 private:
  explicit FrameLog(transport::EventLogReader reader) : reader_(std::move(reader)) {}

  transport::EventLogReader reader_;
  std::string channel_;
  std::vector<image::FrameHeader> frames_;
  std::vector<std::uint64_t> offsets_;  ///< of frames_ in the file
  geometry::CameraModel camera_;
  std::vector<std::int64_t> skipped_utimes_;
  LogDamage damage_;
};

}  // namespace eg::recording
