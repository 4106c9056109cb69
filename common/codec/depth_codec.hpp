#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "common/base/result.hpp"

namespace eg::codec {

/// Compresses a depth image without loss: differences along each row, low and high bytes in planes of their own, then
/// one Zstandard frame (RFC 8878) at level 1. On structured-light depth it is smaller than PNG and ten times as fast,
/// because neighbouring depths differ little and the high bytes of their differences are nearly constant.
/// @param depth CV_16UC1, not empty, any row stride
/// @return the payload; it carries no size, which the reader must know
std::vector<std::uint8_t> encode_depth(const cv::Mat& depth);

/// The image that encode_depth() was given. Never allocates more than three images of the size asked for, whatever the
/// payload claims.
/// @param width, height pixels, positive
/// @return CV_16UC1, height x width; an error if the payload is damaged or of an image of another size
base::Result<cv::Mat> decode_depth(std::span<const std::uint8_t> bytes, int width, int height);

}  // namespace eg::codec
