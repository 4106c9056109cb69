#include "common/io/image_file.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "common/base/check.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/dataset.hpp"
#include "common/io/text_file.hpp"

namespace eg::io {
namespace {

tl::unexpected<base::Error> bad_image(const std::filesystem::path& path, const std::string& what) {
  return base::fail(path.string() + ": " + what);
}

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

std::string type_text(const cv::Mat& image) {
  const auto bits = static_cast<int>(8 * image.elemSize1());
  return std::to_string(bits) + "-bit with " + std::to_string(image.channels()) + " channel" +
         (image.channels() == 1 ? "" : "s");
}

base::Status check_size(const std::filesystem::path& path, const cv::Mat& image, const geometry::CameraModel& camera) {
  if (image.cols == camera.width && image.rows == camera.height) return {};
  return bad_image(path, "image is " + size_text(image.cols, image.rows) + ", but camera '" + camera.name + "' is " +
                             size_text(camera.width, camera.height));
}

/// 8-bit BGR from whatever 8-bit image was stored.
base::Result<cv::Mat> to_bgr(const std::filesystem::path& path, const cv::Mat& image) {
  cv::Mat bgr;
  if (image.type() == CV_8UC3) return image;
  if (image.type() == CV_8UC1) {
    cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
  } else if (image.type() == CV_8UC4) {
    cv::cvtColor(image, bgr, cv::COLOR_BGRA2BGR);
  } else {
    return bad_image(path, "colour image is " + type_text(image) + "; it must be 8-bit");
  }
  return bgr;
}

base::Result<cv::Mat> read_colour(const std::filesystem::path& path, const geometry::CameraModel& camera) {
  const auto image = read_image(path);
  if (!image) return image;
  if (const auto status = check_size(path, *image, camera); !status) return tl::make_unexpected(status.error());
  return to_bgr(path, *image);
}

base::Result<cv::Mat> read_depth(const std::filesystem::path& path, const geometry::CameraModel& camera) {
  const auto image = read_image(path);
  if (!image) return image;
  if (image->type() != CV_16UC1) {
    return bad_image(path, "depth image is " + type_text(*image) + "; it must be 16-bit with 1 channel");
  }
  if (const auto status = check_size(path, *image, camera); !status) return tl::make_unexpected(status.error());
  return image;
}

}  // namespace

base::Result<cv::Mat> read_image(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  if (!bytes) return tl::make_unexpected(bytes.error());
  if (const auto status = check_image_is_whole(*bytes); !status) return bad_image(path, status.error().message);
  const std::vector<std::uint8_t> buffer(bytes->begin(), bytes->end());
  try {
    cv::Mat image = cv::imdecode(buffer, cv::IMREAD_UNCHANGED);
    if (image.empty()) return bad_image(path, "image cannot be decoded");
    return image;
  } catch (const cv::Exception&) {
    return bad_image(path, "image cannot be decoded");
  }
}

base::Status write_png(const std::filesystem::path& path, const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  EG_CHECK(cv::imencode(".png", image, bytes), "OpenCV encodes every image of 8 or 16 bits");
  return write_file_atomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

base::Result<image::RgbdFrame> read_frame(const Dataset& dataset, std::size_t index,
                                          const geometry::CameraModel& camera) {
  EG_CHECK(index < dataset.frames.size(), "no such frame in the data set");
  const DatasetFrame& frame = dataset.frames[index];
  auto colour = read_colour(frame.colour_path, camera);
  if (!colour) return tl::make_unexpected(colour.error());
  auto depth = read_depth(frame.depth_path, camera);
  if (!depth) return tl::make_unexpected(depth.error());
  return image::RgbdFrame{{0, static_cast<std::int64_t>(index), frame.utime}, camera, *colour, *depth};
}

}  // namespace eg::io
