#include "common/messages/bot_images.hpp"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <bot_core/images_t.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "common/codec/depth_codec.hpp"
#include "common/messages/guard.hpp"
#include "common/messages/limits.hpp"

namespace eg::messages {
namespace {

using bot::ImageKind;
using bot::Images;

constexpr std::int32_t kMaxImages = 16;
constexpr std::int32_t kMaxSide = 1 << 15;  // pixels

/// Takes fields from a message whose arrays stand anywhere; after the first mistake nothing more.
class Fields {
 public:
  explicit Fields(ByteView bytes) : bytes_(bytes) {}

  template <typename Integer>
  Integer take(const char* name) {
    std::uint64_t bits = 0;
    for (const std::uint8_t byte : take_bytes(name, sizeof(Integer))) bits = bits << 8U | byte;
    return static_cast<Integer>(bits);
  }
  std::int32_t take_count(const char* name, std::int32_t maximum) {
    const auto count = take<std::int32_t>(name);
    if (count < 0 || count > maximum) fail(name, "is out of range");
    return ok() ? count : 0;
  }
  ByteView take_bytes(const char* name, std::size_t size) {
    if (size > bytes_.size()) fail(name, "is cut off");
    if (!ok()) return {};
    const ByteView taken = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return taken;
  }
  void fail(const char* name, const char* complaint) {
    if (ok()) error_ = std::string("field '") + name + "' " + complaint;
  }
  [[nodiscard]] bool ok() const { return error_.empty(); }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  ByteView bytes_;
  std::string error_;
};

void skip_metadata(Fields& fields) {
  constexpr std::int32_t kMax = 1'000'000;
  for (std::int32_t left = fields.take_count("nmetadata", kMax); left > 0 && fields.ok(); --left) {
    fields.take_bytes("key", static_cast<std::size_t>(fields.take_count("key", kMax)));
    fields.take_bytes("value", static_cast<std::size_t>(fields.take_count("n", kMax)));
  }
}

Images::Image take_image(Fields& fields) {
  constexpr std::int32_t kMaxBytes = 100'000'000;
  Images::Image image;
  fields.take<std::int64_t>("utime");
  image.width = fields.take_count("width", kMaxSide);
  image.height = fields.take_count("height", kMaxSide);
  image.row_stride = fields.take_count("row_stride", kMaxBytes);
  image.pixel_format = fields.take<std::int32_t>("pixelformat");
  const ByteView data = fields.take_bytes("data", static_cast<std::size_t>(fields.take_count("size", kMaxBytes)));
  image.data.assign(data.begin(), data.end());
  skip_metadata(fields);
  return image;
}

base::Result<Images> decode_images(ByteView bytes) {
  Fields fields(bytes);
  if (fields.take<std::uint64_t>("fingerprint") != static_cast<std::uint64_t>(bot_core::images_t::getHash())) {
    fields.fail("fingerprint", "is not that of bot_core.images_t");
  }
  Images images;
  images.utime = fields.take<std::int64_t>("utime");
  if (images.utime < 0 || images.utime > kMaxCounter) fields.fail("utime", "is out of range");
  std::vector<ImageKind> kinds;
  for (std::int32_t left = fields.take_count("n_images", kMaxImages); left > 0; --left) {
    kinds.push_back(static_cast<ImageKind>(fields.take<std::int16_t>("image_types")));
  }
  for (const ImageKind kind : kinds) {
    if (!fields.ok()) break;
    images.images.push_back(take_image(fields));
    images.images.back().kind = kind;
  }
  if (!fields.ok()) return base::fail(fields.error());
  if (!fields.at_end()) return base::fail("bytes are left over behind the message");
  return images;
}

const Images::Image* find(const Images& images, std::initializer_list<ImageKind> kinds) {
  const auto found = std::find_if(images.images.begin(), images.images.end(), [&](const Images::Image& image) {
    return std::find(kinds.begin(), kinds.end(), image.kind) != kinds.end();
  });
  return found == images.images.end() ? nullptr : &*found;
}

bool has_size(const Images::Image& image, const geometry::CameraModel& camera) {
  return image.width == camera.width && image.height == camera.height;
}

/// The rows of an image of `pixel_bytes` bytes per pixel; empty: there are not enough bytes.
cv::Mat rows_of(const Images::Image& image, int type, std::size_t pixel_bytes) {
  const std::size_t packed = pixel_bytes * static_cast<std::size_t>(image.width);
  const std::size_t stride = image.row_stride == 0 ? packed : static_cast<std::size_t>(image.row_stride);
  const auto height = static_cast<std::size_t>(image.height);
  if (stride < packed || height == 0 || image.data.size() < stride * (height - 1) + packed) return {};
  return cv::Mat(image.height, image.width, type, const_cast<std::uint8_t*>(image.data.data()), stride).clone();
}

base::Status take_colour(const Images::Image& image, CompressedFrame& frame) {
  if (image.pixel_format == bot::kPixelFormatMjpeg) {
    frame.colour = image.data;
    return {};
  }
  if (image.pixel_format != bot::kPixelFormatRgb) return base::fail("field 'pixelformat' is neither MJPEG nor RGB");
  cv::Mat colour = rows_of(image, CV_8UC3, 3);
  if (colour.empty()) return base::fail("the colour image is cut off");
  cv::cvtColor(colour, colour, cv::COLOR_RGB2BGR);
  frame.colour = codec::encode_colour(colour, frame.colour_encoding);
  return {};
}

base::Status take_depth(Images::Image image, CompressedFrame& frame) {
  if (image.kind == ImageKind::depth_mm_zipped) {
    Bytes plain(sizeof(std::uint16_t) * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    uLongf size = plain.size();
    if (uncompress(plain.data(), &size, image.data.data(), image.data.size()) != Z_OK || size != plain.size()) {
      return base::fail("the depth image does not unpack to the size of the camera's images");
    }
    image.data = std::move(plain);
    image.row_stride = 0;
  }
  static_assert(std::endian::native == std::endian::little, "depth is sent with its low byte first");
  const cv::Mat depth = rows_of(image, CV_16UC1, sizeof(std::uint16_t));
  if (depth.empty()) return base::fail("the depth image is cut off");
  frame.depth = codec::encode_depth(depth);
  return {};
}

}  // namespace

template <>
base::Result<Images> decode(ByteView bytes) {
  return guarded<Images>([&] { return decode_images(bytes); });
}

base::Result<CompressedFrame> bot::to_frame(const Images& images, const geometry::CameraModel& camera) {
  const Images::Image* colour = find(images, {ImageKind::left});
  const Images::Image* depth = find(images, {ImageKind::depth_mm, ImageKind::depth_mm_zipped});
  if (colour == nullptr) return base::fail("there is no colour image (LEFT)");
  if (depth == nullptr) return base::fail("there is no depth image (DEPTH_MM or DEPTH_MM_ZIPPED)");
  if (!has_size(*colour, camera) || !has_size(*depth, camera)) {
    return base::fail("the images are not of the camera's " + std::to_string(camera.width) + " x " +
                      std::to_string(camera.height) + " pixels");
  }
  CompressedFrame frame;
  frame.header.utime = images.utime;
  frame.camera = camera;
  frame.camera.depth_units_per_metre = 1000.0;  // as the types of the images say, whatever the camera is used to
  if (const auto taken = take_colour(*colour, frame); !taken) return tl::make_unexpected(taken.error());
  if (const auto taken = take_depth(*depth, frame); !taken) return tl::make_unexpected(taken.error());
  // A damaged JPEG would be refused by every receiver: better here, by name.
  if (const auto whole = decompress(frame); !whole) return tl::make_unexpected(whole.error());
  return frame;
}

}  // namespace eg::messages
