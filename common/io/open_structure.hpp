#pragma once

#include <filesystem>

#include "common/base/result.hpp"
#include "common/observations/recording.hpp"

namespace eg::io {

/// Reads a folder in the text format of Open-Structure (Li, Guo, Yang, Sun, Zhao, Tombari, RA-L 2024):
///   venom_sequence.txt   MappointFrameAsso: POINT FRAME u v
///                        MaplineFrameAsso: LINE FRAME u1 v1 depth1 u2 v2 depth2
///                        ParalineMaplineAsso: GROUP COUNT LINE ...
///                        and Vertex:, Mappoint:, Mapline:, another system's starting values, which are not read
///   ground_truth.txt     FRAME tx ty tz qx qy qz qw, camera to world, 30 frames per second
///   point_landmarks.txt  POINT x y z, world: the true depth of points, which are recorded without
/// Errors name FILE:LINE: a line of another form, numbers that are none, unknown frames and points, a landmark that is
/// observed twice in a frame or behind the camera, a line in two groups, more features in a frame than a message
/// carries.
base::Result<observations::Recording> read_open_structure(const std::filesystem::path& folder);

}  // namespace eg::io
