#include "common/codec/depth_codec.hpp"

#include <zstd.h>

#include <string>

#include "common/base/check.hpp"

namespace eg::codec {
namespace {

constexpr int kCompressionLevel = 1;

/// Small differences of either sign become small numbers: 0, -1, 1, -2, ... → 0, 1, 2, 3, ... The difference is taken
/// modulo 2^16, so that every image comes back exactly.
std::uint16_t zigzag(std::uint16_t difference) {
  const std::uint16_t sign = (difference & 0x8000U) != 0 ? 0xffffU : 0U;
  return static_cast<std::uint16_t>(static_cast<std::uint16_t>(difference << 1U) ^ sign);
}

std::uint16_t unzigzag(std::uint16_t code) {
  const std::uint16_t sign = (code & 1U) != 0 ? 0xffffU : 0U;
  return static_cast<std::uint16_t>((code >> 1U) ^ sign);
}

/// The row differences of the image: all low bytes, then all high bytes.
std::vector<std::uint8_t> split_row_differences(const cv::Mat& depth) {
  const std::size_t pixels = depth.total();
  std::vector<std::uint8_t> planes(2 * pixels);
  std::uint8_t* low = planes.data();
  std::uint8_t* high = planes.data() + pixels;
  for (int y = 0; y < depth.rows; ++y) {
    const auto* row = depth.ptr<std::uint16_t>(y);
    std::uint16_t left = 0;
    for (int x = 0; x < depth.cols; ++x) {
      const std::uint16_t code = zigzag(static_cast<std::uint16_t>(row[x] - left));
      *low++ = static_cast<std::uint8_t>(code & 0xffU);
      *high++ = static_cast<std::uint8_t>(code >> 8U);
      left = row[x];
    }
  }
  return planes;
}

cv::Mat join_row_differences(const std::vector<std::uint8_t>& planes, int width, int height) {
  cv::Mat depth(height, width, CV_16UC1);
  const std::uint8_t* low = planes.data();
  const std::uint8_t* high = planes.data() + depth.total();
  for (int y = 0; y < height; ++y) {
    auto* row = depth.ptr<std::uint16_t>(y);
    std::uint16_t left = 0;
    for (int x = 0; x < width; ++x) {
      const auto code = static_cast<std::uint16_t>(*low++ | (*high++ << 8));
      left = static_cast<std::uint16_t>(left + unzigzag(code));
      row[x] = left;
    }
  }
  return depth;
}

}  // namespace

std::vector<std::uint8_t> encode_depth(const cv::Mat& depth) {
  EG_CHECK(!depth.empty() && depth.type() == CV_16UC1, "a depth image is CV_16UC1 and not empty");
  const std::vector<std::uint8_t> planes = split_row_differences(depth);
  std::vector<std::uint8_t> bytes(ZSTD_compressBound(planes.size()));
  const std::size_t size = ZSTD_compress(bytes.data(), bytes.size(), planes.data(), planes.size(), kCompressionLevel);
  EG_CHECK(ZSTD_isError(size) == 0, "the output buffer has the size that Zstandard asked for");
  bytes.resize(size);
  return bytes;
}

base::Result<cv::Mat> decode_depth(std::span<const std::uint8_t> bytes, int width, int height) {
  EG_CHECK(width > 0 && height > 0, "an image has a positive size");
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (ZSTD_getFrameContentSize(bytes.data(), bytes.size()) != 2 * pixels) {
    return base::fail("the compressed depth is no image of " + std::to_string(width) + " x " + std::to_string(height));
  }
  if (ZSTD_findFrameCompressedSize(bytes.data(), bytes.size()) != bytes.size()) {
    return base::fail("the compressed depth is truncated or followed by other bytes");
  }
  std::vector<std::uint8_t> planes(2 * pixels);
  if (ZSTD_decompress(planes.data(), planes.size(), bytes.data(), bytes.size()) != planes.size()) {
    return base::fail("the compressed depth is damaged");
  }
  return join_row_differences(planes, width, height);
}

}  // namespace eg::codec
