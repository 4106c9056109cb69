#include "services/frame_source/image_pairer.hpp"

#include <cstdlib>
#include <utility>

namespace eg::services {

std::optional<messages::bot::Images> ImagePairer::add(Images::Image image, std::int64_t utime) {
  std::optional<Waiting>& own = image.kind == messages::bot::ImageKind::left ? colour_ : depth_;
  own = Waiting{std::move(image), utime};
  if (!colour_ || !depth_) return std::nullopt;
  const std::int64_t lead = colour_->utime - depth_->utime;
  if (std::abs(lead) > max_difference_) {
    (lead > 0 ? depth_ : colour_).reset();
    return std::nullopt;
  }
  Images pair{colour_->utime, {}};
  pair.images.push_back(std::move(colour_->image));
  pair.images.push_back(std::move(depth_->image));
  colour_.reset();
  depth_.reset();
  return pair;
}

}  // namespace eg::services
