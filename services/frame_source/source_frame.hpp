#pragma once

#include <variant>

#include "common/features/features.hpp"
#include "common/messages/codec.hpp"

namespace eg::services {

/// What a source sends: images for the feature extractor, or the features of a recording that has no images. Images are
/// compressed where they are read, so that this delays nobody, and those of a log stay as they are.
using SourceFrame = std::variant<messages::CompressedFrame, features::FrameFeatures>;

inline image::FrameHeader& header_of(SourceFrame& frame) {
  return std::visit([](auto& content) -> image::FrameHeader& { return content.header; }, frame);
}
inline const image::FrameHeader& header_of(const SourceFrame& frame) {
  return std::visit([](const auto& content) -> const image::FrameHeader& { return content.header; }, frame);
}

}  // namespace eg::services
