#pragma once

#include <filesystem>

#include "services/mapper/keyframe_map.hpp"

namespace eg::services {

/// Writes the grids to the last bit, the keyframes' poses and their images as far as they are kept; whole or not at
/// all.
base::Status save_dense_archive(const std::filesystem::path& path, const KeyframeMap& map);

/// Reads them into a map that is empty so far. Refuses what is damaged, of another version, incomplete, out of range or
/// made with other options, naming file and record; the map is then not to be used.
base::Status load_dense_archive(const std::filesystem::path& path, KeyframeMap& map);

}  // namespace eg::services
