#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace eg::services {

/// A compressed image as it came in an RGBD message.
struct StoredImage {
  std::string content_type;  ///< "image/jpeg" or "image/png"
  std::vector<std::uint8_t> bytes;
};

/// The colour images of keyframes, by id, the youngest as far as the budget reaches. Used by several threads.
class KeyframeImages {
 public:
  explicit KeyframeImages(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  void put(std::int32_t keyframe, StoredImage image);
  void clear();
  /// Null: there is none.
  [[nodiscard]] std::shared_ptr<const StoredImage> find(std::int32_t keyframe) const;

 private:
  mutable std::mutex mutex_;
  std::size_t max_bytes_;
  std::size_t total_bytes_ = 0;
  std::map<std::int32_t, std::shared_ptr<const StoredImage>> images_;
};

}  // namespace eg::services
