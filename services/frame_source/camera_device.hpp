#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "common/base/result.hpp"
#include "common/messages/bot_images.hpp"

namespace eg::services {

/// A depth camera at this machine.
class CameraDevice {
 public:
  virtual ~CameraDevice() = default;

  /// Waits at most `timeout` for a colour image and the depth image of the same moment. Nothing: none came in time. An
  /// error: the camera is gone. Called from one thread.
  virtual base::Result<std::optional<messages::bot::Images>> read(std::chrono::milliseconds timeout) = 0;

  /// One line for the log: which camera, in which mode.
  [[nodiscard]] virtual std::string description() const = 0;
};

}  // namespace eg::services
