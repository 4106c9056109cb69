#include "common/io/camera_file.hpp"

#include <algorithm>
#include <cctype>
#include <regex>

#include "common/io/atomic_file.hpp"
#include "common/io/config.hpp"
#include "common/io/nearest_name.hpp"

namespace eg::io {
namespace {

namespace fs = std::filesystem;

ConfigSchema camera_schema(geometry::CameraModel& camera) {
  ConfigSchema schema;
  schema.field("width", camera.width, {1, 8192}, "pixels").required();
  schema.field("height", camera.height, {1, 8192}, "pixels").required();
  schema.field("fx", camera.fx, {}, "pixels").required();
  schema.field("fy", camera.fy, {}, "pixels; negative if the camera's y axis points up").required();
  schema.field("cx", camera.cx, {}, "pixels, 0 is the centre of the first pixel").required();
  schema.field("cy", camera.cy, {}, "pixels").required();
  schema.list("distortion", camera.distortion.data(), camera.distortion.size(), {}, "k1, k2, p1, p2, k3");
  schema.field("depth_units_per_metre", camera.depth_units_per_metre, {}, "the depth scale is never guessed")
      .required();
  schema.field("fps", camera.fps, {}, "nominal frame rate, 1/s").required();
  return schema;
}

base::Result<geometry::CameraModel> read_camera_file(const fs::path& path) {
  geometry::CameraModel camera;
  camera.name = path.stem().string();
  if (const auto status = read_config(path, camera_schema(camera)); !status) {
    return tl::make_unexpected(status.error());
  }
  if (const auto status = geometry::validate(camera); !status) {
    return base::fail(path.string() + ": " + status.error().message);
  }
  return camera;
}

bool looks_like_a_file(const std::string& text) {
  std::error_code ignored;
  return text.ends_with(".yaml") || text.ends_with(".yml") || text.find('/') != std::string::npos ||
         fs::is_regular_file(text, ignored);
}

std::string known_cameras() { return joined(geometry::camera_names()); }

/// The last two components of the resolved path, lower case, each between slashes.
std::string folder_name(const fs::path& folder) {
  std::error_code error;
  fs::path resolved = fs::weakly_canonical(folder, error);
  if (error) resolved = folder.lexically_normal();
  if (!resolved.has_filename()) resolved = resolved.parent_path();
  std::string name = ("/" / resolved.parent_path().filename() / resolved.filename() / "").string();
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

std::optional<std::string> camera_by_folder_name(const std::string& name) {
  // A digit after the number would make it another one (fr10), a letter before it another word.
  static const std::regex tum(R"((freiburg|[^a-z]fr)([123])(?![0-9]))");
  static const std::regex icl(R"([^a-z]icl[^a-z]|living_?room|office_?room|traj[0-3]_frei_png|[^a-z](of|lr)_?kt[0-9])");
  std::smatch match;
  if (std::regex_search(name, match, tum)) return "tum_fr" + match[2].str();
  if (std::regex_search(name, icl)) return "icl";
  return std::nullopt;
}

}  // namespace

base::Result<geometry::CameraModel> read_camera(const std::string& name_or_file) {
  if (const auto camera = geometry::find_camera(name_or_file)) return *camera;
  if (looks_like_a_file(name_or_file)) return read_camera_file(name_or_file);
  return base::fail("unknown camera '" + name_or_file + "'; known: " + known_cameras() + ", or a YAML file");
}

base::Status write_camera(const fs::path& path, const geometry::CameraModel& camera) {
  geometry::CameraModel copy = camera;
  return write_file_atomically(path, print_config(camera_schema(copy)));
}

base::Result<ResolvedCamera> resolve_camera(const fs::path& dataset_folder, const std::optional<std::string>& option) {
  const auto resolved = [](const std::string& name_or_file, const std::string& how) {
    return read_camera(name_or_file).map([&](const geometry::CameraModel& camera) {
      return ResolvedCamera{camera, "camera " + name_or_file + how};
    });
  };
  if (option) return resolved(*option, ", as asked for");
  const fs::path in_folder = dataset_folder / "camera.yaml";
  std::error_code ignored;
  if (fs::exists(in_folder, ignored)) return resolved(in_folder.string(), ", found in the data set");
  if (const auto name = camera_by_folder_name(folder_name(dataset_folder)))
    return resolved(*name, ", by the folder's name");
  return base::fail(dataset_folder.string() +
                    ": its camera is not known; give --camera NAME or --camera FILE.yaml (names: " + known_cameras() +
                    ")");
}

}  // namespace eg::io
