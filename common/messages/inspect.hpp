#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/messages/codec.hpp"

namespace eg::messages {

/// What tools can say of any message without knowing where it came from.
struct MessageInfo {
  std::string type;                     ///< e.g. "rgbd_t"; of other projects' types the fingerprint in hexadecimal
  std::string error;                    ///< why decode() refuses it; empty: it does not
  std::optional<std::int64_t> session;  ///< which recording or robot, if the type says so
  /// Counts up within a session on its channel, so that a gap is a lost message: a frame's sequence, a keyframe's
  /// number, a graph update's or a correction's version.
  std::optional<std::int64_t> number;
  std::optional<std::int64_t> utime;  ///< of the frame (keyframe) it is about, or when a status was sent; microseconds
};

/// Decodes and validates everything but images.
MessageInfo inspect(ByteView bytes);

}  // namespace eg::messages
