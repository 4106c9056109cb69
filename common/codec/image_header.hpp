#pragma once

#include <cstdint>
#include <span>

#include "common/base/result.hpp"

namespace eg::codec {

struct ImageSize {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels

  bool operator==(const ImageSize&) const = default;
};

/// The size that a JPEG file's frame header states (ITU-T T.81, B.2.2), without decoding. Only baseline JPEG of 8 bits
/// with three components that ends in an end-of-image marker is accepted.
base::Result<ImageSize> read_jpeg_size(std::span<const std::uint8_t> bytes);

/// The size that a PNG file's IHDR chunk states (ISO/IEC 15948, 11.2.2), without decoding. Only 8-bit RGB without
/// interlacing that ends in an IEND chunk is accepted.
base::Result<ImageSize> read_png_size(std::span<const std::uint8_t> bytes);

}  // namespace eg::codec
