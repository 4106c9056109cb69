#include "services/frame_source/camera_reader.hpp"

#include <utility>

namespace eg::services {
namespace {

constexpr std::size_t kMostWaiting = 2;
constexpr std::chrono::milliseconds kWait{100};  // for images, before the thread looks whether it is to end

}  // namespace

CameraReader::CameraReader(std::unique_ptr<CameraDevice> camera)
    : camera_(std::move(camera)), thread_([this](const std::stop_token& stop) { read_all(stop); }) {}

base::Result<std::optional<messages::bot::Images>> CameraReader::take() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) {
    if (error_) return tl::make_unexpected(*error_);
    return std::optional<messages::bot::Images>();
  }
  std::optional<messages::bot::Images> images = std::move(waiting_.front());
  waiting_.pop_front();
  return images;
}

void CameraReader::read_all(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    auto images = camera_->read(kWait);
    const std::lock_guard lock(mutex_);
    if (!images) {
      error_ = images.error();
      return;
    }
    if (!images->has_value()) continue;
    waiting_.push_back(**std::move(images));
    if (waiting_.size() > kMostWaiting) waiting_.pop_front();
  }
}

}  // namespace eg::services
