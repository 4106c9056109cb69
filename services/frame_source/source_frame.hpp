#pragma once

#include <variant>

#include "common/features/features.hpp"
#include "common/image/rgbd_frame.hpp"

namespace eg::services {

/// What a source sends: images for the feature extractor, or the features of a recording that has no images.
using SourceFrame = std::variant<image::RgbdFrame, features::FrameFeatures>;

inline image::FrameHeader& header_of(SourceFrame& frame) {
  return std::visit([](auto& content) -> image::FrameHeader& { return content.header; }, frame);
}
inline const image::FrameHeader& header_of(const SourceFrame& frame) {
  return std::visit([](const auto& content) -> const image::FrameHeader& { return content.header; }, frame);
}

}  // namespace eg::services
