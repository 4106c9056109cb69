#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/geometry/pose.hpp"

namespace eg::io {

/// Trajectories in TUM format, one pose per line: time tx ty tz qx qy qz qw (seconds, metres, unit quaternion), camera
/// to world; lines from '#' are comments. Times increase strictly.

struct TrajectoryOptions {
  double index_rate =
      30.0;  ///< ICL-NUIM's *.gt.freiburg count images: if all times are small integers, time is index / rate
};

/// Errors name FILE:LINE: a line of another form, a value that is no finite number, a quaternion whose norm is not 1
/// (within 1 %), times that do not increase, no pose at all.
base::Result<std::vector<geometry::StampedPose>> read_trajectory(const std::filesystem::path& path,
                                                                 const TrajectoryOptions& options = {});

/// Time with 6 decimals, values with 9 significant digits, qw >= 0: equal poses give equal bytes.
std::string format_trajectory(std::span<const geometry::StampedPose> trajectory);

base::Status write_trajectory(const std::filesystem::path& path, std::span<const geometry::StampedPose> trajectory);

}  // namespace eg::io
