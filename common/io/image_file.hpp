#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

#include "common/base/result.hpp"

namespace eg::io {

/// Reads a PNG or JPEG image as it is stored (depth, channels; no rotation by EXIF). A file that is cut short or, as
/// PNG, fails a checksum is an error: the decoders alone return such images half filled.
base::Result<cv::Mat> read_image(const std::filesystem::path& path);

/// Writes an image as PNG, whole or not at all, whatever the file's name ends with. 8 or 16 bits, not empty.
base::Status write_png(const std::filesystem::path& path, const cv::Mat& image);

/// Whether encoded bytes are a whole PNG (every chunk with its checksum, up to IEND) or a whole JPEG (every segment, up
/// to the end-of-image marker). The error says what is wrong, without a path.
base::Status check_image_is_whole(std::string_view bytes);

}  // namespace eg::io
