#pragma once

#include <cstdint>
#include <map>
#include <set>

#include "common/messages/control.hpp"
#include "services/frame_source/source_frame.hpp"

namespace eg::services {

inline constexpr std::size_t kFramesStored = 300;  ///< ten seconds of a camera, some 30 MB
inline constexpr int kRequestQueue = 8;            ///< RESEND messages that wait; they are repeated

/// The frames sent last, for receivers that missed one and cannot do without it. What is asked for waits in a queue, so
/// that sending it again never delays new frames for long.
class FrameStore {
 public:
  /// @param frames kept; a compressed frame takes some 0.1 MB
  explicit FrameStore(std::size_t frames) : capacity_(frames) {}

  void add(SourceFrame frame);

  /// Notes those of the frames that are still here.
  void request(const messages::ResendRequest& request);

  /// The next frame to send again, once; null if none is asked for.
  const SourceFrame* next();

 private:
  std::size_t capacity_;
  std::map<std::int64_t, SourceFrame> frames_;  ///< by sequence
  std::set<std::int64_t> requested_;
};

}  // namespace eg::services
