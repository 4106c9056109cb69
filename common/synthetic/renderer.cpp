#include "common/synthetic/renderer.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/check.hpp"

namespace eg::synthetic {
namespace {

using Eigen::Vector2d;

constexpr int kTile = 16;          // pixels
constexpr int kSubsamples = 3;     // per axis, at silhouettes and creases
constexpr float kSharpest = 5.0F;  // bound on how much a grazing view stretches a pixel's footprint

/// From linear light to sRGB bytes, with a soft shoulder instead of clipping.
class ToneCurve {
 public:
  ToneCurve() {
    for (int i = 0; i < kSize; ++i) {
      const double light = kBrightest * i / (kSize - 1);
      const double shown = 1.0 - std::exp(-1.7 * light);
      const double encoded = shown <= 0.0031308 ? 12.92 * shown : 1.055 * std::pow(shown, 1.0 / 2.4) - 0.055;
      bytes_[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(255.0 * encoded));
    }
  }
  [[nodiscard]] std::uint8_t operator()(float light) const {
    const float index =
        std::clamp(light, 0.0F, static_cast<float>(kBrightest)) * ((kSize - 1) / static_cast<float>(kBrightest));
    return bytes_[static_cast<std::size_t>(index + 0.5F)];
  }

 private:
  static constexpr int kSize = 8192;
  static constexpr double kBrightest = 4.0;
  std::array<std::uint8_t, kSize> bytes_{};
};

cv::Vec3b to_bgr(const Colour& light) {
  static const ToneCurve curve;
  return {curve(light.z()), curve(light.y()), curve(light.x())};
}

/// Everything one render() call shares between its tiles.
struct Frame {
  const Scene& scene;
  const geometry::CameraModel& camera;
  const PixelRays& rays;
  const std::vector<LightMap>& light;
  std::vector<Patch> patches;
  Rendering& out;

  /// Light from the patch at a ray; `sharpness`: 1 for a whole pixel, less for a part of it.
  [[nodiscard]] Colour shade(const Patch& patch, const Vector2d& ray, float pixel_share) const {
    const auto index = static_cast<std::size_t>(patch.surface);
    const double z = 1.0 / evaluate(patch.inverse_depth, ray);
    const Eigen::Vector2f uv(static_cast<float>(z * evaluate(patch.u, ray) + patch.u_origin),
                             static_cast<float>(z * evaluate(patch.v, ray) + patch.v_origin));
    const double cosine = -evaluate(patch.normal, ray) / std::sqrt(ray.squaredNorm() + 1.0);
    const float stretch = std::min(kSharpest, static_cast<float>(1.0 / std::max(cosine, 1e-3)));
    const float footprint = pixel_share * stretch * static_cast<float>(z / camera.fx);
    const Material& material = scene.surfaces[index].material;
    return (light[index].sample(uv) + material.glow) * reflectance(material, uv, footprint);
  }
};

/// One tile of the image: first which patch every pixel sees (and one pixel more all around), then their colours.
class Tile {
 public:
  Tile(const Frame& frame, int left, int top, const RayBox& box)
      : frame_(frame),
        box_(box),
        left_(left),
        top_(top),
        width_(std::min(kTile, frame.camera.width - left)),
        height_(std::min(kTile, frame.camera.height - top)) {}

  void draw() {
    patches_in_box(frame_.patches, box_, candidates_);
    for (int y = -1; y <= height_; ++y) {
      for (int x = -1; x <= width_; ++x) seen(x, y) = nearest_patch(candidates_, frame_.rays.at(left_ + x, top_ + y));
    }
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) draw_pixel(x, y);
    }
  }

 private:
  const Patch*& seen(int x, int y) { return seen_[static_cast<std::size_t>((y + 1) * (kTile + 2) + x + 1)]; }

  bool at_edge(int x, int y) {
    const Patch* middle = seen(x, y);
    return seen(x - 1, y) != middle || seen(x + 1, y) != middle || seen(x, y - 1) != middle || seen(x, y + 1) != middle;
  }

  void draw_pixel(int x, int y) {
    const Patch* patch = seen(x, y);
    const Vector2d& ray = frame_.rays.at(left_ + x, top_ + y);
    const int column = left_ + x;
    const int row = top_ + y;
    Colour colour = Colour::Zero();
    if (at_edge(x, y)) {
      colour = mean_over_pixel(column, row);
    } else if (patch != nullptr) {
      colour = frame_.shade(*patch, ray, 1.0F);
    }
    frame_.out.colour.at<cv::Vec3b>(row, column) = to_bgr(colour);
    frame_.out.surface.at<std::int16_t>(row, column) = static_cast<std::int16_t>(patch ? patch->surface : -1);
    frame_.out.depth.at<float>(row, column) =
        patch ? static_cast<float>(1.0 / evaluate(patch->inverse_depth, ray)) : 0.0F;
  }

  [[nodiscard]] Colour mean_over_pixel(int column, int row) const {
    const Vector2d& ray = frame_.rays.at(column, row);
    const Vector2d step_x = frame_.rays.step_x(column, row) / kSubsamples;
    const Vector2d step_y = frame_.rays.step_y(column, row) / kSubsamples;
    Colour sum = Colour::Zero();
    for (int i = 0; i < kSubsamples * kSubsamples; ++i) {
      const double right = i % kSubsamples - 0.5 * (kSubsamples - 1);
      const double down = i / kSubsamples - 0.5 * (kSubsamples - 1);
      const Vector2d sample = ray + right * step_x + down * step_y;
      const Patch* patch = nearest_patch(candidates_, sample);
      if (patch != nullptr) sum += frame_.shade(*patch, sample, 1.0F / kSubsamples);
    }
    return sum / static_cast<float>(kSubsamples * kSubsamples);
  }

  const Frame& frame_;
  const RayBox& box_;
  int left_, top_, width_, height_;
  std::vector<const Patch*> candidates_;
  std::array<const Patch*, static_cast<std::size_t>((kTile + 2) * (kTile + 2))> seen_{};
};

/// The rays of every tile and of one more pixel around it, tiles by row.
std::vector<RayBox> tile_boxes(const PixelRays& rays, int width, int height) {
  std::vector<RayBox> boxes;
  for (int top = 0; top < height; top += kTile) {
    for (int left = 0; left < width; left += kTile) {
      Eigen::AlignedBox2d box;
      for (int y = top - 1; y <= std::min(top + kTile, height); ++y) {
        for (int x = left - 1; x <= std::min(left + kTile, width); ++x) box.extend(rays.at(x, y));
      }
      boxes.push_back({box.center(), 0.5 * box.sizes()});
    }
  }
  return boxes;
}

}  // namespace

Renderer::Renderer(Scene scene, const geometry::CameraModel& camera)
    : scene_(std::move(scene)),
      camera_(camera),
      rays_(camera),
      tiles_(tile_boxes(rays_, camera.width, camera.height)),
      light_(bake_lighting(scene_)) {
  EG_CHECK(geometry::validate(camera).has_value(), "a renderer needs a valid camera");
}

Rendering Renderer::render(const geometry::Pose& world_from_camera) const {
  Rendering out{cv::Mat(camera_.height, camera_.width, CV_8UC3), cv::Mat(camera_.height, camera_.width, CV_32FC1),
                cv::Mat(camera_.height, camera_.width, CV_16SC1)};
  const Frame frame{scene_, camera_, rays_, light_, visible_patches(scene_, world_from_camera), out};
  const int columns = (camera_.width + kTile - 1) / kTile;
  tbb::parallel_for(0, static_cast<int>(tiles_.size()), [&](int index) {
    Tile(frame, index % columns * kTile, index / columns * kTile, tiles_[static_cast<std::size_t>(index)]).draw();
  });
  return out;
}

}  // namespace eg::synthetic
