#pragma once

#include <cstdint>
#include <vector>

#include "common/messages/codec.hpp"

namespace eg::messages::bot {

enum class ImageKind : std::int16_t { left = 0, depth_mm = 4, depth_mm_zipped = 6 };

inline constexpr std::int32_t kPixelFormatMjpeg = 1'196'444'237;
inline constexpr std::int32_t kPixelFormatRgb = 859'981'650;

/// bot_core.images_t: what a camera's driver publishes for one moment.
struct Images {
  struct Image {
    ImageKind kind = ImageKind::left;  ///< may be one that is not named above
    std::int32_t width = 0;            ///< pixels
    std::int32_t height = 0;
    std::int32_t row_stride = 0;  ///< bytes
    std::int32_t pixel_format = 0;
    Bytes data;
  };
  std::int64_t utime = 0;  ///< microseconds
  std::vector<Image> images;
};

/// The colour image (kind left, MJPEG or RGB) and the depth image (millimetres, little-endian, plain or compressed by
/// zlib) of a camera. The error names what is missing or of another size than the camera's.
base::Result<CompressedFrame> to_frame(const Images& images, const geometry::CameraModel& camera);

}  // namespace eg::messages::bot

namespace eg::messages {

/// Metadata are left out. Allocates nothing before its bytes are there.
template <>
base::Result<bot::Images> decode(ByteView bytes);

}  // namespace eg::messages
