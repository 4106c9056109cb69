#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "services/frame_source/camera_device.hpp"

namespace eg::services {

/// Reads a camera on a thread of its own, so that no image is missed while the service does something else. Two pairs
/// of images wait; what waits longer is dropped for newer ones.
class CameraReader {
 public:
  explicit CameraReader(std::unique_ptr<CameraDevice> camera);

  /// The oldest pair that waits. After the camera has gone: its error.
  base::Result<std::optional<messages::bot::Images>> take();

 private:
  void read_all(const std::stop_token& stop);

  std::unique_ptr<CameraDevice> camera_;
  std::mutex mutex_;
  std::deque<messages::bot::Images> waiting_;
  std::optional<base::Error> error_;
  std::jthread thread_;  // last: ends before what it uses goes
};

}  // namespace eg::services
