#include "services/frame_source/read_ahead.hpp"

#include <exception>
#include <utility>

namespace eg::services {
namespace {

/// Image libraries throw on what they cannot do; on this thread that must become an error like any other.
base::Result<SourceFrame> read_guarded(const FrameInput& input, std::int64_t index) {
  try {
    return input.read(index);
  } catch (const std::exception& exception) {
    return base::fail("frame " + std::to_string(index) + ": " + exception.what());
  }
}

}  // namespace

ReadAhead::ReadAhead(std::shared_ptr<const FrameInput> input, std::size_t frames_ahead)
    : input_(std::move(input)),
      frames_ahead_(frames_ahead),
      reader_([this](const std::stop_token& stop) { read_all(stop); }) {}

std::optional<ReadAhead::Item> ReadAhead::take(std::chrono::milliseconds timeout) {
  if (exhausted()) return std::nullopt;
  std::unique_lock lock(mutex_);
  if (!changed_.wait_for(lock, timeout, [this] { return !ready_.empty(); })) return std::nullopt;
  Item item = std::move(ready_.front());
  ready_.pop_front();
  ++taken_;
  lock.unlock();
  changed_.notify_all();
  return item;
}

void ReadAhead::read_all(const std::stop_token& stop) {
  for (std::int64_t index = 0; index < input_->size() && !stop.stop_requested(); ++index) {
    Item item{index, read_guarded(*input_, index)};
    std::unique_lock lock(mutex_);
    if (!changed_.wait(lock, stop, [this] { return ready_.size() < frames_ahead_; })) return;
    ready_.push_back(std::move(item));
    lock.unlock();
    changed_.notify_all();
  }
}

}  // namespace eg::services
