#include "common/geometry/camera_model.hpp"

#include <algorithm>
#include <cmath>

namespace eg::geometry {
namespace {

// Sizes above this are no camera but a mistake; it bounds every allocation made for an image.
constexpr int kMaxImageSide = 8192;

/// TUM RGB-D: the calibrations its authors publish. Its depth images come scaled by 5000.
/// ICL-NUIM: the authors' POV-Ray camera, with the sign of fy that belongs to the published poses.
const std::vector<CameraModel>& known_cameras() {
  static const std::vector<CameraModel> cameras = {
      {"icl", 640, 480, 481.20, -480.00, 319.50, 239.50, {}, 5000.0, 30.0},
      {"tum_fr1", 640, 480, 517.306408, 516.469215, 318.643040, 255.313989,
       {0.262383, -0.953104, -0.005358, 0.002628, 1.163314}, 5000.0, 30.0},
      {"tum_fr2", 640, 480, 520.908620, 521.007327, 325.141442, 249.701764,
       {0.231222, -0.784899, -0.003257, -0.000105, 0.917205}, 5000.0, 30.0},
      {"tum_fr3", 640, 480, 535.4, 539.2, 320.1, 247.6, {}, 5000.0, 30.0},
      {"synthetic", 640, 480, 525.0, 525.0, 319.5, 239.5, {}, 5000.0, 30.0},
  };
  return cameras;
}

}  // namespace

bool CameraModel::has_distortion() const {
  return std::any_of(distortion.begin(), distortion.end(), [](double k) { return k != 0.0; });
}

base::Status validate(const CameraModel& camera) {
  const auto out_of_range = [](int side) { return side < 1 || side > kMaxImageSide; };
  if (out_of_range(camera.width)) return base::fail("camera width must be in [1, 8192] pixels");
  if (out_of_range(camera.height)) return base::fail("camera height must be in [1, 8192] pixels");
  if (!std::isfinite(camera.fx) || camera.fx <= 0) return base::fail("camera fx must be positive");
  if (!std::isfinite(camera.fy) || camera.fy == 0) return base::fail("camera fy must be finite and not zero");
  if (!std::isfinite(camera.cx) || !std::isfinite(camera.cy)) return base::fail("camera cx and cy must be finite");
  for (const double k : camera.distortion) {
    if (!std::isfinite(k)) return base::fail("camera distortion must be finite");
  }
  if (!std::isfinite(camera.depth_units_per_metre) || camera.depth_units_per_metre <= 0) {
    return base::fail("camera depth_units_per_metre must be positive: the depth scale is never guessed");
  }
  if (!std::isfinite(camera.fps) || camera.fps <= 0) return base::fail("camera fps must be positive");
  return {};
}

std::optional<CameraModel> find_camera(std::string_view name) {
  const auto& cameras = known_cameras();
  const auto it = std::find_if(cameras.begin(), cameras.end(), [&](const CameraModel& c) { return c.name == name; });
  if (it == cameras.end()) return std::nullopt;
  return *it;
}

std::vector<std::string> camera_names() {
  std::vector<std::string> names;
  for (const CameraModel& camera : known_cameras()) names.push_back(camera.name);
  return names;
}

}  // namespace eg::geometry
