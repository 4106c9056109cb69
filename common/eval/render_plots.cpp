#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "common/eval/draw.hpp"
#include "common/eval/render.hpp"
#include "common/eval/view.hpp"
#include "common/geometry/so3.hpp"

namespace eg::eval {
namespace {

const cv::Scalar kPaper(255, 255, 255);
const cv::Scalar kFrameColour(200, 200, 200);
const cv::Scalar kInk(60, 60, 60);

struct Plot {
  const char* title;
  OrthographicView view;
};

/// The scene's own horizontal axes, seen along each of the three.
std::array<Plot, 3> plots_for(const RenderOptions& options) {
  const Eigen::Vector3d up = options.up.normalized();
  Eigen::Vector3d ahead = options.ahead - options.ahead.dot(up) * up;
  ahead = ahead.norm() > 1e-6 ? ahead.normalized() : geometry::tangent_basis(up).col(0).eval();
  const double half_turn = std::numbers::pi / 2;
  const auto view = [&](double azimuth, double elevation) {
    return OrthographicView(up, ahead, azimuth, elevation, options.mirrored);
  };
  return {
      {{"from above", view(0.0, half_turn)}, {"from behind", view(0.0, 0.0)}, {"from the side", view(half_turn, 0.0)}}};
}

}  // namespace

cv::Mat plot_paths(std::span<const Path> paths, const RenderOptions& options, int width, int height) {
  constexpr int kMargin = 36;
  const std::vector<Eigen::Vector3d> points = points_of(paths);
  cv::Mat image(height, width, CV_8UC3, kPaper);
  const std::array<Plot, 3> plots = plots_for(options);
  for (std::size_t i = 0; i < plots.size(); ++i) {
    const int left = width * static_cast<int>(i) / 3, right = width * static_cast<int>(i + 1) / 3;
    cv::Mat panel = image.colRange(left, right);
    OrthographicView view = plots[i].view;
    view.fit({}, points, {kMargin, kMargin, panel.cols - 2 * kMargin, panel.rows - 2 * kMargin});
    for (const Path& path : paths) draw_path(panel, path, view, 1);
    cv::rectangle(panel, {0, 0, panel.cols, panel.rows}, kFrameColour);
    draw_text(panel, plots[i].title, {12, 20}, kInk);
    draw_scale_bar(panel, view.pixels_per_metre());
  }
  return image;
}

}  // namespace eg::eval
