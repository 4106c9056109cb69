#include "common/codec/colour_codec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "common/base/random.hpp"
#include "common/codec/image_header.hpp"

namespace eg::codec {
namespace {

using testing::HasSubstr;

cv::Mat gradient(int width, int height) {
  cv::Mat colour(height, width, CV_8UC3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      colour.at<cv::Vec3b>(y, x) =
          cv::Vec3b(static_cast<std::uint8_t>(255 * x / width), static_cast<std::uint8_t>(255 * y / height), 128);
    }
  }
  return colour;
}

std::vector<std::uint8_t> encode_file(const std::string& extension, const cv::Mat& image,
                                      const std::vector<int>& parameters = {}) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, image, bytes, parameters);
  return bytes;
}

std::string complaint(const base::Result<cv::Mat>& result) { return result ? "none" : result.error().message; }

TEST(ColourCodec, PngIsExact) {
  base::Random random(1);
  cv::Mat colour(21, 33, CV_8UC3);
  for (auto& pixel : cv::Mat_<cv::Vec3b>(colour)) {
    for (int i = 0; i < 3; ++i) pixel[i] = static_cast<std::uint8_t>(random.index(256));
  }
  const auto decoded = decode_colour(encode_colour(colour, ColourEncoding::png), ColourEncoding::png, 33, 21);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->type(), CV_8UC3);
  EXPECT_EQ(cv::norm(*decoded, colour, cv::NORM_INF), 0.0);
}

TEST(ColourCodec, JpegIsCloseAndSmallerWithLessQuality) {
  const cv::Mat colour = gradient(160, 120);
  const auto good = encode_colour(colour, ColourEncoding::jpeg);
  const auto poor = encode_colour(colour, ColourEncoding::jpeg, 30);
  EXPECT_LT(poor.size(), good.size());
  const auto decoded = decode_colour(good, ColourEncoding::jpeg, 160, 120);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_LT(cv::norm(*decoded, colour, cv::NORM_L1) / static_cast<double>(3 * colour.total()), 2.0);
}

TEST(ColourCodec, DecodesTheSameEveryTime) {
  const auto bytes = encode_colour(gradient(160, 120), ColourEncoding::jpeg);
  const auto first = decode_colour(bytes, ColourEncoding::jpeg, 160, 120);
  const auto second = decode_colour(bytes, ColourEncoding::jpeg, 160, 120);
  EXPECT_EQ(cv::norm(*first, *second, cv::NORM_INF), 0.0);
}

TEST(ColourCodec, SaysWhichSizeItFound) {
  for (const auto encoding : {ColourEncoding::jpeg, ColourEncoding::png}) {
    const auto bytes = encode_colour(gradient(40, 30), encoding);
    EXPECT_EQ(complaint(decode_colour(bytes, encoding, 30, 40)), "the colour image has 40 x 30 pixels, not 30 x 40");
  }
}

TEST(ColourCodec, RefusesOtherKindsOfImages) {
  const cv::Mat colour = gradient(16, 16);
  const cv::Mat grey(16, 16, CV_8UC1, cv::Scalar(1));
  const auto jpeg = [](const std::vector<std::uint8_t>& file) {
    return complaint(decode_colour(file, ColourEncoding::jpeg, 16, 16));
  };
  const auto png = [](const std::vector<std::uint8_t>& file) {
    return complaint(decode_colour(file, ColourEncoding::png, 16, 16));
  };
  EXPECT_THAT(jpeg(encode_file(".png", colour)), HasSubstr("no JPEG"));
  EXPECT_THAT(png(encode_file(".jpg", colour)), HasSubstr("no PNG"));
  EXPECT_THAT(jpeg(encode_file(".jpg", grey)), HasSubstr("three components"));
  EXPECT_THAT(png(encode_file(".png", grey)), HasSubstr("not 8-bit RGB"));
  EXPECT_THAT(png(encode_file(".png", cv::Mat(16, 16, CV_16UC3, cv::Scalar(1)))), HasSubstr("not 8-bit RGB"));
  EXPECT_THAT(jpeg(encode_file(".jpg", colour, {cv::IMWRITE_JPEG_PROGRESSIVE, 1})), HasSubstr("not baseline"));
  EXPECT_THAT(jpeg(encode_file(".bmp", colour)), HasSubstr("no JPEG"));
}

TEST(ColourCodec, RefusesTruncatedFiles) {
  for (const auto encoding : {ColourEncoding::jpeg, ColourEncoding::png}) {
    const auto bytes = encode_colour(gradient(40, 30), encoding);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const std::vector<std::uint8_t> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
      ASSERT_FALSE(decode_colour(cut, encoding, 40, 30)) << size;
    }
  }
}

TEST(ColourCodec, SurvivesDamagedHeaders) {
  for (const auto encoding : {ColourEncoding::jpeg, ColourEncoding::png}) {
    const auto bytes = encode_colour(gradient(40, 30), encoding);
    base::Random random(2);
    for (int attempt = 0; attempt < 300; ++attempt) {
      auto damaged = bytes;
      damaged[static_cast<std::size_t>(random.index(60))] = static_cast<std::uint8_t>(random.index(256));
      const auto decoded = decode_colour(damaged, encoding, 40, 30);
      EXPECT_TRUE(!decoded || decoded->size() == cv::Size(40, 30));
    }
  }
}

TEST(ImageHeader, ReadsSizesWithoutDecoding) {
  const cv::Mat wide = gradient(300, 2);
  EXPECT_EQ(read_jpeg_size(encode_file(".jpg", wide)).value(), (ImageSize{300, 2}));
  EXPECT_EQ(read_png_size(encode_file(".png", wide)).value(), (ImageSize{300, 2}));
}

TEST(ImageHeader, RefusesSegmentsThatRunOutOfTheFile) {
  const std::vector<std::uint8_t> bytes = {0xff, 0xd8, 0xff, 0xe0, 0xff, 0xff, 0xff, 0xd9};
  EXPECT_FALSE(read_jpeg_size(bytes));
  const std::vector<std::uint8_t> shortest = {0xff, 0xd8, 0xff, 0xd9};
  EXPECT_FALSE(read_jpeg_size(shortest));
}

}  // namespace
}  // namespace eg::codec
