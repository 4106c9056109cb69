#include "services/viewer/keyframe_images.hpp"

#include <utility>

namespace eg::services {

void KeyframeImages::put(std::int32_t keyframe, StoredImage image) {
  const std::scoped_lock lock(mutex_);
  if (image.bytes.size() > max_bytes_) return;
  auto& place = images_[keyframe];
  if (place) total_bytes_ -= place->bytes.size();
  total_bytes_ += image.bytes.size();
  place = std::make_shared<const StoredImage>(std::move(image));
  while (total_bytes_ > max_bytes_) {
    const auto oldest = images_.begin();
    total_bytes_ -= oldest->second->bytes.size();
    images_.erase(oldest);
  }
}

void KeyframeImages::clear() {
  const std::scoped_lock lock(mutex_);
  images_.clear();
  total_bytes_ = 0;
}

std::shared_ptr<const StoredImage> KeyframeImages::find(std::int32_t keyframe) const {
  const std::scoped_lock lock(mutex_);
  const auto found = images_.find(keyframe);
  return found == images_.end() ? nullptr : found->second;
}

}  // namespace eg::services
