#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "common/base/result.hpp"

namespace eg::codec {

enum class ColourEncoding : std::uint8_t {
  jpeg = 0,  ///< baseline JPEG: small
  png = 1,   ///< PNG: exact
};

inline constexpr int kDefaultJpegQuality = 90;

/// @param colour CV_8UC3, BGR, not empty
/// @param quality of JPEG, 1 to 100; PNG takes no notice
std::vector<std::uint8_t> encode_colour(const cv::Mat& colour, ColourEncoding encoding,
                                        int quality = kDefaultJpegQuality);

/// The image: exactly what was encoded if by PNG. The size is read from the file's header and compared before any pixel
/// is allocated; only what encode_colour() writes is accepted (baseline JPEG with three components, PNG with 8-bit
/// RGB).
/// @param width, height pixels, positive
/// @return CV_8UC3, BGR, height x width; an error if the payload is damaged, or of another size or kind
base::Result<cv::Mat> decode_colour(std::span<const std::uint8_t> bytes, ColourEncoding encoding, int width,
                                    int height);

}  // namespace eg::codec
