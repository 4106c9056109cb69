#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/image/rgbd_frame.hpp"

namespace eg::io {

/// One colour and depth image pair of a recording, not yet read.
struct DatasetFrame {
  double time_s = 0.0;     ///< of the colour image
  std::int64_t utime = 0;  ///< the same, microseconds
  std::filesystem::path colour_path;
  std::filesystem::path depth_path;
};

enum class DatasetLayout : std::uint8_t {
  lists,         ///< TUM RGB-D: rgb.txt and depth.txt, associated here by time
  associations,  ///< associations.txt, associate.txt or association.txt: pairs made by somebody else
  numbered,      ///< ICL-NUIM without lists: rgb/0.png, depth/0.png, ...
};
std::string_view to_string(DatasetLayout layout);

struct DatasetOptions {
  double max_time_difference_s = 0.02;  ///< between the colour and the depth image of a pair
  double index_rate = 30.0;             ///< images per second where the time stamps are image numbers
};

/// A recording on disk (docs/datasets.md).
struct Dataset {
  std::filesystem::path folder;
  DatasetLayout layout = DatasetLayout::lists;
  std::vector<DatasetFrame> frames;    ///< in strictly increasing time, at least one
  std::int64_t unpaired_colour = 0;    ///< colour images without a depth partner
  std::int64_t unpaired_depth = 0;     ///< depth images without a colour partner
  std::filesystem::path ground_truth;  ///< groundtruth.txt or *.gt.freiburg; empty: none
};

/// Finds the pairs of a recording. The images themselves are not opened.
/// Errors: no such folder, no known layout, missing or empty list, a line that is no entry, time stamps that do not
/// increase, image paths that leave the folder, no pair within the tolerance. Each names FILE:LINE.
base::Result<Dataset> open_dataset(const std::filesystem::path& folder, const DatasetOptions& options = {});

/// Reads pair `index` (which must exist); the header carries sequence = index, utime, and session 0.
/// Errors: an image that is missing, damaged, cut short or not of the camera's size; colour that is not 8-bit (grey is
/// converted); depth that is not 16-bit with one channel.
base::Result<image::RgbdFrame> read_frame(const Dataset& dataset, std::size_t index,
                                          const geometry::CameraModel& camera);

}  // namespace eg::io
