#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "common/recording/frame_log.hpp"

namespace eg::log_tool {

/// Which of the robots and sessions in a log is meant.
struct Selection {
  std::string channel_prefix;           ///< of the channel names
  std::optional<std::int64_t> session;  ///< nothing: the only one
};

/// Writes the colour and depth images as a data set in TUM RGB-D layout with camera.yaml, for egraph-run --dataset:
/// colour as it was recorded (JPEG or PNG), depth as PNG. Returns how many frames.
base::Result<std::int64_t> extract_images(const std::filesystem::path& log, const Selection& selection,
                                          const std::filesystem::path& folder);

/// Writes the poses of all frames that have one as a trajectory in TUM format, each frame's last. Returns how many.
base::Result<std::int64_t> extract_poses(const std::filesystem::path& log, const Selection& selection,
                                         const std::filesystem::path& file);

/// Writes the features as CSV, one per line: sequence, utime, kind and the numbers that the first line names. Returns
/// how many.
base::Result<std::int64_t> extract_features(const std::filesystem::path& log, const Selection& selection,
                                            const std::filesystem::path& file);

}  // namespace eg::log_tool
