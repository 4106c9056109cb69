#include "common/codec/colour_codec.hpp"

#include <opencv2/imgcodecs.hpp>
#include <string>

#include "common/base/check.hpp"
#include "common/codec/image_header.hpp"

namespace eg::codec {

std::vector<std::uint8_t> encode_colour(const cv::Mat& colour, ColourEncoding encoding, int quality) {
  EG_CHECK(!colour.empty() && colour.type() == CV_8UC3, "a colour image is CV_8UC3 and not empty");
  EG_CHECK(quality >= 1 && quality <= 100, "the quality of JPEG is in [1, 100]");
  std::vector<std::uint8_t> bytes;
  const bool done = encoding == ColourEncoding::jpeg
                        ? cv::imencode(".jpg", colour, bytes, {cv::IMWRITE_JPEG_QUALITY, quality})
                        : cv::imencode(".png", colour, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  EG_CHECK(done, "OpenCV encodes every CV_8UC3 image");
  return bytes;
}

base::Result<cv::Mat> decode_colour(std::span<const std::uint8_t> bytes, ColourEncoding encoding, int width,
                                    int height) {
  EG_CHECK(width > 0 && height > 0, "an image has a positive size");
  const auto size = encoding == ColourEncoding::jpeg ? read_jpeg_size(bytes) : read_png_size(bytes);
  if (!size) return tl::make_unexpected(size.error());
  if (*size != ImageSize{width, height}) {
    return base::fail("the colour image has " + std::to_string(size->width) + " x " + std::to_string(size->height) +
                      " pixels, not " + std::to_string(width) + " x " + std::to_string(height));
  }
  // imdecode() only reads, but takes what it reads as vector or matrix.
  const std::vector<std::uint8_t> file(bytes.begin(), bytes.end());
  cv::Mat colour;
  try {
    colour = cv::imdecode(file, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    return base::fail("the colour image is damaged");
  }
  if (colour.type() != CV_8UC3 || colour.cols != width || colour.rows != height) {
    return base::fail("the colour image is damaged");
  }
  return colour;
}

}  // namespace eg::codec
