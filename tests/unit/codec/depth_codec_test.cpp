#include "common/codec/depth_codec.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "common/base/random.hpp"

namespace eg::codec {
namespace {

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

cv::Mat noise(int width, int height, std::uint64_t seed) {
  base::Random random(seed);
  cv::Mat depth(height, width, CV_16UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) depth.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(random.next());
  }
  return depth;
}

/// A slanted wall with holes: what depth images look like.
cv::Mat wall(int width, int height) {
  cv::Mat depth(height, width, CV_16UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      depth.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>((x / 20 + y / 20) % 7 == 0 ? 0 : 5000 + 3 * x + y);
    }
  }
  return depth;
}

TEST(DepthCodec, IsLosslessForEveryImage) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(7, 1), cv::Size(1, 7), cv::Size(33, 21)}) {
    const cv::Mat depth = noise(size.width, size.height, 1);
    const auto decoded = decode_depth(encode_depth(depth), size.width, size.height);
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_TRUE(same(*decoded, depth));
  }
}

TEST(DepthCodec, KeepsTheExtremes) {
  const cv::Mat depth = (cv::Mat_<std::uint16_t>(2, 4) << 0, 65535, 0, 32768, 65535, 1, 32767, 0);
  EXPECT_TRUE(same(decode_depth(encode_depth(depth), 4, 2).value(), depth));
}

TEST(DepthCodec, TakesImagesWithPaddedRows) {
  const cv::Mat depth = noise(40, 30, 2)(cv::Rect(5, 6, 17, 11));
  EXPECT_TRUE(same(decode_depth(encode_depth(depth), 17, 11).value(), depth));
}

TEST(DepthCodec, CompressesDepth) {
  const cv::Mat depth = wall(640, 480);
  EXPECT_LT(encode_depth(depth).size(), depth.total() * 2 / 20);
}

TEST(DepthCodec, RefusesAnotherSize) {
  const auto bytes = encode_depth(wall(64, 48));
  EXPECT_FALSE(decode_depth(bytes, 64, 47));
  EXPECT_FALSE(decode_depth(bytes, 65, 48));
  EXPECT_FALSE(decode_depth(bytes, 60000, 60000));
  EXPECT_TRUE(decode_depth(bytes, 48, 64)) << "the payload knows the number of pixels only";
}

TEST(DepthCodec, RefusesTruncatedAndTrailingBytes) {
  auto bytes = encode_depth(wall(64, 48));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::uint8_t> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_FALSE(decode_depth(cut, 64, 48)) << size;
  }
  bytes.push_back(0);
  EXPECT_FALSE(decode_depth(bytes, 64, 48));
}

TEST(DepthCodec, SurvivesDamage) {
  const auto bytes = encode_depth(wall(64, 48));
  base::Random random(3);
  for (int attempt = 0; attempt < 2000; ++attempt) {
    auto damaged = bytes;
    damaged[static_cast<std::size_t>(random.index(static_cast<int>(bytes.size())))] ^=
        static_cast<std::uint8_t>(1 + random.index(255));
    const auto decoded = decode_depth(damaged, 64, 48);
    EXPECT_TRUE(!decoded || decoded->size() == cv::Size(64, 48));
  }
}

}  // namespace
}  // namespace eg::codec
