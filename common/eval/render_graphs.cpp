#include <algorithm>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "common/eval/draw.hpp"
#include "common/eval/render.hpp"
#include "common/eval/view.hpp"

namespace eg::eval {
namespace {

const cv::Scalar kPaper(255, 255, 255);
const cv::Scalar kFrameColour(200, 200, 200);
const cv::Scalar kInk(60, 60, 60);
constexpr int kMargin = 48;
constexpr double kEdgeOpacity = 0.5;

}  // namespace

cv::Mat render_graphs(std::span<const Eigen::Vector3d> keyframes, std::span<const PlottedGraph> graphs,
                      const RenderOptions& options) {
  const int count = std::max<int>(1, static_cast<int>(graphs.size()));
  cv::Mat image(options.height, options.width, CV_8UC3, kPaper);
  OrthographicView view(options.up, options.ahead, 0.0, std::numbers::pi / 2, options.mirrored);
  for (int i = 0; i < static_cast<int>(graphs.size()); ++i) {
    const PlottedGraph& graph = graphs[static_cast<std::size_t>(i)];
    cv::Mat panel = image.colRange(options.width * i / count, options.width * (i + 1) / count);
    view.fit({}, keyframes, {kMargin, kMargin, panel.cols - 2 * kMargin, panel.rows - 2 * kMargin});
    cv::Mat edges = panel.clone();
    for (const auto& [first, second] : graph.edges) {
      draw_line(edges, view.pixel(keyframes[first]), view.pixel(keyframes[second]), graph.colour, 1);
    }
    cv::addWeighted(edges, kEdgeOpacity, panel, 1.0 - kEdgeOpacity, 0.0, panel);
    for (const Eigen::Vector3d& keyframe : keyframes) cv::circle(panel, view.pixel(keyframe), 3, kInk, cv::FILLED);
    cv::rectangle(panel, {0, 0, panel.cols, panel.rows}, kFrameColour);
    draw_text(panel, graph.title + ": " + std::to_string(graph.edges.size()) + " edges", {16, 26}, kInk);
    draw_scale_bar(panel, view.pixels_per_metre());
  }
  return image;
}

}  // namespace eg::eval
