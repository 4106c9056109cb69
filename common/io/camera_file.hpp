#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/base/result.hpp"
#include "common/geometry/camera_model.hpp"

namespace eg::io {

/// The camera model of a name (geometry::find_camera) or of a YAML file with the keys
///   width height fx fy cx cy distortion: [k1, k2, p1, p2, k3] depth_units_per_metre fps
/// of which only `distortion` may be left out (none then). Errors: unknown name, with the names known; unreadable file;
/// bad key or value, with its line; no depth scale, because that is never guessed.
base::Result<geometry::CameraModel> read_camera(const std::string& name_or_file);

/// Writes a camera model as such a YAML file.
base::Status write_camera(const std::filesystem::path& path, const geometry::CameraModel& camera);

/// A camera and how it was found, e.g. "camera tum_fr3, by the folder's name".
struct ResolvedCamera {
  geometry::CameraModel camera;
  std::string how;
};

/// The camera of a recording: `option` (a name or file) if given, else camera.yaml in the folder, else by the last two
/// parts of the folder's path (docs/datasets.md: fr1 or freiburg1, ..., icl, living_room, of_kt2, ...), else an error
/// that names --camera.
base::Result<ResolvedCamera> resolve_camera(const std::filesystem::path& dataset_folder,
                                            const std::optional<std::string>& option);

}  // namespace eg::io
