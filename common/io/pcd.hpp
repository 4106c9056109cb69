#pragma once

#include <filesystem>
#include <string>

#include "common/io/ply.hpp"

/// Point clouds in the format of the Point Cloud Library (PCD 0.7).
namespace eg::io {

/// The vertices as binary PCD: x y z, normal_x normal_y normal_z if there are normals, and rgb (packed into a float, as
/// PCL has it) if there are colours. Triangles and edges are left out.
std::string format_pcd(const PlyView& cloud);

/// Written whole or not at all.
base::Status write_pcd(const std::filesystem::path& path, const PlyView& cloud);

}  // namespace eg::io
