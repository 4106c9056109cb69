#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "common/base/result.hpp"

/// The text files that name a recording's images.
namespace eg::io {

/// One image of a recording: when it was taken and where it is.
struct ListedImage {
  double time_s = 0.0;
  std::int64_t utime = 0;      ///< the same, microseconds
  std::filesystem::path path;  ///< folder of the recording included
};

/// Reads rgb.txt or depth.txt: "timestamp filename" per line, in strictly increasing time, at least one.
/// If every time stamp is an integer without a decimal point and small enough to be an image number, it is one, and the
/// time is number / index_rate.
base::Result<std::vector<ListedImage>> read_image_list(const std::filesystem::path& list, double index_rate);

/// A line of an association file.
struct ListedPair {
  ListedImage colour;
  ListedImage depth;
};

/// Reads "timestamp filename timestamp filename" per line. Which of the two is depth is told by the word "depth" in its
/// file name. Colour times increase strictly; image numbers as in read_image_list().
base::Result<std::vector<ListedPair>> read_association_list(const std::filesystem::path& list, double index_rate);

}  // namespace eg::io
