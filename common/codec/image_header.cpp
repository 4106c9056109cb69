#include "common/codec/image_header.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace eg::codec {
namespace {

using Bytes = std::span<const std::uint8_t>;

int big_endian_16(Bytes bytes, std::size_t at) { return bytes[at] << 8 | bytes[at + 1]; }

std::uint32_t big_endian_32(Bytes bytes, std::size_t at) {
  return static_cast<std::uint32_t>(big_endian_16(bytes, at)) << 16U |
         static_cast<std::uint32_t>(big_endian_16(bytes, at + 2));
}

template <std::size_t N>
bool starts_with(Bytes bytes, const std::array<std::uint8_t, N>& prefix) {
  return bytes.size() >= N && std::equal(prefix.begin(), prefix.end(), bytes.begin());
}

template <std::size_t N>
bool ends_with(Bytes bytes, const std::array<std::uint8_t, N>& suffix) {
  return bytes.size() >= N && std::equal(suffix.begin(), suffix.end(), bytes.end() - N);
}

// JPEG markers (T.81, table B.1).
constexpr std::uint8_t kBaselineFrame = 0xc0;
constexpr std::uint8_t kStartOfScan = 0xda;
constexpr std::array<std::uint8_t, 2> kStartOfImage = {0xff, 0xd8};
constexpr std::array<std::uint8_t, 2> kEndOfImage = {0xff, 0xd9};

bool is_other_frame(std::uint8_t marker) {
  const bool table = marker == 0xc4 || marker == 0xc8 || marker == 0xcc;
  return marker > 0xc0 && marker <= 0xcf && !table;
}

base::Result<ImageSize> read_frame_header(Bytes segment) {
  constexpr std::size_t kLengthWithThreeComponents = 17;
  if (segment.size() != kLengthWithThreeComponents || segment[2] != 8 || segment[7] != 3) {
    return base::fail("the JPEG image does not have three components of 8 bits");
  }
  return ImageSize{big_endian_16(segment, 5), big_endian_16(segment, 3)};
}

}  // namespace

base::Result<ImageSize> read_jpeg_size(Bytes bytes) {
  if (!starts_with(bytes, kStartOfImage)) return base::fail("the colour image is no JPEG");
  if (!ends_with(bytes, kEndOfImage)) return base::fail("the JPEG image is truncated");
  std::size_t at = kStartOfImage.size();
  while (at + 4 <= bytes.size() && bytes[at] == 0xff) {
    const std::uint8_t marker = bytes[at + 1];
    const auto length = static_cast<std::size_t>(big_endian_16(bytes, at + 2));
    if (length < 2 || length > bytes.size() - at - 2) break;
    if (marker == kBaselineFrame) return read_frame_header(bytes.subspan(at + 2, length));
    if (is_other_frame(marker)) return base::fail("the JPEG image is not baseline");
    if (marker == kStartOfScan) break;
    at += 2 + length;
  }
  return base::fail("the JPEG image has no frame header");
}

base::Result<ImageSize> read_png_size(Bytes bytes) {
  constexpr std::array<std::uint8_t, 16> kStart = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n',
                                                   0,    0,   0,   13,  'I',  'H',  'D',  'R'};
  constexpr std::array<std::uint8_t, 12> kEnd = {0, 0, 0, 0, 'I', 'E', 'N', 'D', 0xae, 0x42, 0x60, 0x82};
  // After the start: width, height (4 bytes each), then depth, colour type, compression, filter, interlacing.
  constexpr std::array<std::uint8_t, 5> kEightBitRgb = {8, 2, 0, 0, 0};
  constexpr std::size_t kFormatAt = kStart.size() + 8;
  constexpr std::uint32_t kMaxSide = 0xffff;

  if (!starts_with(bytes, kStart)) return base::fail("the colour image is no PNG");
  if (bytes.size() < kFormatAt + kEightBitRgb.size() + kEnd.size() || !ends_with(bytes, kEnd)) {
    return base::fail("the PNG image is truncated");
  }
  if (!starts_with(bytes.subspan(kFormatAt), kEightBitRgb)) return base::fail("the PNG image is not 8-bit RGB");
  const std::uint32_t width = big_endian_32(bytes, kStart.size());
  const std::uint32_t height = big_endian_32(bytes, kStart.size() + 4);
  if (width > kMaxSide || height > kMaxSide) return base::fail("the PNG image is too large");
  return ImageSize{static_cast<int>(width), static_cast<int>(height)};
}

}  // namespace eg::codec
