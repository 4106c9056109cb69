#pragma once

#include <cstdint>
#include <optional>

#include "common/messages/bot_images.hpp"

namespace eg::services {

/// Puts the images of a camera's two streams together that were taken at the same time.
class ImagePairer {
 public:
  using Images = messages::bot::Images;

  /// @param max_difference microseconds between a colour image and the depth image that goes with it
  explicit ImagePairer(std::int64_t max_difference) : max_difference_(max_difference) {}

  /// Takes the next image of a stream, told by its kind; `utime` in microseconds. Returns the pair that it completes,
  /// under the colour image's time. Of two that are too far apart the older one is dropped.
  std::optional<Images> add(Images::Image image, std::int64_t utime);

 private:
  struct Waiting {
    Images::Image image;
    std::int64_t utime = 0;
  };

  std::int64_t max_difference_;
  std::optional<Waiting> colour_;
  std::optional<Waiting> depth_;
};

}  // namespace eg::services
