#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/eval/draw.hpp"
#include "common/eval/rasterizer.hpp"
#include "common/eval/render.hpp"
#include "common/eval/view.hpp"

namespace eg::eval {
namespace {

// Everything is drawn this much larger and then averaged, against jagged edges.
constexpr int kOversampling = 2;
constexpr int kMargin = 40;
// Not white, so that what was never seen does not look like white furniture.
const cv::Vec3b kBackground(238, 230, 224);
const cv::Vec3f kUncoloured(190, 190, 190);
const cv::Scalar kKeyframeColour(40, 40, 40);

/// Lambert's law with a light above and behind the viewer; surfaces turned away from it keep some ambient light.
class Light {
 public:
  Light(const Eigen::Vector3d& up, const Eigen::Vector3d& forward) : to_light_((up - 1.5 * forward).normalized()) {}

  [[nodiscard]] float intensity(const Eigen::Vector3d& normal) const {
    constexpr double kAmbient = 0.6;
    return static_cast<float>(kAmbient + (1.0 - kAmbient) * std::max(normal.dot(to_light_), 0.0));
  }

 private:
  Eigen::Vector3d to_light_;
};

cv::Vec3f colour_at(const ColouredSurface& surface, std::uint32_t vertex) {
  if (surface.colours.empty()) return kUncoloured;
  const auto& [red, green, blue] = surface.colours[vertex];
  return {static_cast<float>(blue), static_cast<float>(green), static_cast<float>(red)};
}

/// The way a triangle faces: what its vertices say, else what the order of its corners says.
Eigen::Vector3d facing_of(const ColouredSurface& surface, const std::array<std::uint32_t, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  if (!surface.normals.empty()) {
    return (surface.normals[a] + surface.normals[b] + surface.normals[c]).cast<double>().normalized();
  }
  const auto& v = surface.shape.vertices;
  return (v[b] - v[a]).cross(v[c] - v[a]).cast<double>().normalized();
}

void draw_surface(const ColouredSurface& surface, const OrthographicView& view, const Light& light,
                  Rasterizer& rasterizer) {
  for (const auto& triangle : surface.shape.triangles) {
    const Eigen::Vector3d facing = facing_of(surface, triangle);
    if (!(facing.dot(view.forward()) < 0.0)) continue;
    std::array<RasterVertex, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t index = triangle[i];
      const Eigen::Vector3d point = surface.shape.vertices[index].cast<double>();
      const Eigen::Vector3d normal = surface.normals.empty() ? facing : surface.normals[index].cast<double>().eval();
      corners[i] = {view.pixel(point), view.depth(point), light.intensity(normal) * colour_at(surface, index)};
    }
    rasterizer.draw(corners);
  }
}

std::vector<Eigen::Vector3d> points_of(const ColouredSurface& surface) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& vertex : surface.shape.vertices) points.push_back(vertex.cast<double>());
  return points;
}

/// A view pyramid of 12 cm with a typical field of view, open at the camera's y.
void draw_keyframe(cv::Mat& image, const geometry::Pose& world_from_camera, const OrthographicView& view) {
  constexpr double kDepth = 0.12, kHalfWidth = 0.07, kHalfHeight = 0.05;
  const std::array<Eigen::Vector3d, 4> corners = {{{-kHalfWidth, -kHalfHeight, kDepth},
                                                   {kHalfWidth, -kHalfHeight, kDepth},
                                                   {kHalfWidth, kHalfHeight, kDepth},
                                                   {-kHalfWidth, kHalfHeight, kDepth}}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const cv::Point2d corner = view.pixel(world_from_camera * corners[i]);
    draw_line(image, view.pixel(world_from_camera.translation), corner, kKeyframeColour, 1);
    draw_line(image, corner, view.pixel(world_from_camera * corners[(i + 1) % 4]), kKeyframeColour, 1);
  }
}

}  // namespace

RenderOptions render_options_for(bool y_up) {
  RenderOptions options;
  if (y_up) options.up = Eigen::Vector3d::UnitY();
  options.mirrored = y_up;
  return options;
}

cv::Mat render_scene(const ColouredSurface& surface, std::span<const Path> paths,
                     std::span<const geometry::Pose> keyframes, const RenderOptions& options) {
  OrthographicView view(options.up, options.ahead, options.azimuth, options.elevation, options.mirrored);
  const cv::Size size(options.width * kOversampling, options.height * kOversampling);
  const int margin = kMargin * kOversampling;
  view.fit(points_of(surface), points_of(paths), {margin, margin, size.width - 2 * margin, size.height - 2 * margin});

  Rasterizer rasterizer(size, kBackground);
  draw_surface(surface, view, Light(options.up, view.forward()), rasterizer);
  cv::Mat large = rasterizer.image();
  for (const geometry::Pose& keyframe : keyframes) draw_keyframe(large, keyframe, view);
  for (const Path& path : paths) draw_path(large, path, view, 2 * kOversampling);

  cv::Mat image;
  cv::resize(large, image, {options.width, options.height}, 0, 0, cv::INTER_AREA);
  draw_legend(image, paths);
  draw_scale_bar(image, view.pixels_per_metre() / kOversampling);
  return image;
}

}  // namespace eg::eval
