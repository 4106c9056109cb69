#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/geometry/pose.hpp"
#include "common/synthetic/lighting.hpp"
#include "common/synthetic/patch.hpp"
#include "common/synthetic/pixel_rays.hpp"
#include "common/synthetic/scene.hpp"

namespace eg::synthetic {

/// What a perfect camera sees.
struct Rendering {
  cv::Mat colour;   ///< CV_8UC3, BGR, sRGB, smooth at edges
  cv::Mat depth;    ///< CV_32FC1, metres along the optical axis at the pixel's centre; 0 where there is nothing
  cv::Mat surface;  ///< CV_16SC1, index into Scene::surfaces at the pixel's centre; -1 where there is nothing
};

/// Draws a scene for one camera, exactly: the ray of every pixel (through the lens distortion, if any) is intersected
/// with every surface that can be there. Deterministic, for any number of threads.
class Renderer {
 public:
  Renderer(Scene scene, const geometry::CameraModel& camera);

  [[nodiscard]] Rendering render(const geometry::Pose& world_from_camera) const;

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const geometry::CameraModel& camera() const { return camera_; }

 private:
  Scene scene_;
  geometry::CameraModel camera_;
  PixelRays rays_;
  std::vector<RayBox> tiles_;
  std::vector<LightMap> light_;
};

}  // namespace eg::synthetic
