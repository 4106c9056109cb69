#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "services/frame_source/frame_input.hpp"

namespace eg::services {

/// Reads an input on a thread of its own, a few frames ahead, so that reading and compressing images does not delay
/// those who wait for them. Frames come out in order, and each once, however the threads are scheduled.
class ReadAhead {
 public:
  struct Item {
    std::int64_t index = 0;
    base::Result<SourceFrame> frame;
  };

  ReadAhead(std::shared_ptr<const FrameInput> input, std::size_t frames_ahead);

  /// The next frame if it is there within `timeout`.
  std::optional<Item> take(std::chrono::milliseconds timeout);

  /// True when all frames have been taken.
  [[nodiscard]] bool exhausted() const { return taken_ == input_->size(); }

 private:
  void read_all(const std::stop_token& stop);

  std::shared_ptr<const FrameInput> input_;
  std::size_t frames_ahead_;
  std::int64_t taken_ = 0;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Item> ready_;
  std::jthread reader_;  // last: ends before what it uses goes
};

}  // namespace eg::services
