#pragma once

#include <filesystem>
#include <string>

#include "services/mapper/keyframe_map.hpp"
#include "services/mapper/mapper_options.hpp"

namespace eg::services {

/// `name`, with the number of this mapper's share behind a dot if there are several.
std::string with_share(const std::string& name, const mapping::TsdfOptions& options);

/// Gives a map that is empty so far the memory that the options say, with a folder in `out` for the rest.
base::Status limit_memory(const std::filesystem::path& out, const MapperOptions& options, KeyframeMap& map);

/// Goes on in the dense part of a map archive.
base::Status load_map(const std::filesystem::path& archive, KeyframeMap& map);

/// Writes mesh.ply, mesh.pcd, mesh.vdb and the dense part of the map archive, with every keyframe at its latest pose.
base::Status save_map(const std::filesystem::path& out, KeyframeMap& map);

}  // namespace eg::services
