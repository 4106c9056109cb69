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

void draw_map(cv::Mat panel, std::span<const Eigen::Vector3d> keyframes, const PlottedGraph& graph,
              const RenderOptions& options) {
  OrthographicView view(options.up, options.ahead, 0.0, std::numbers::pi / 2, options.mirrored);
  view.fit({}, keyframes, {kMargin, kMargin, panel.cols - 2 * kMargin, panel.rows - 2 * kMargin});
  cv::Mat edges = panel.clone();
  for (const auto& [first, second] : graph.edges) {
    draw_line(edges, view.pixel(keyframes[first]), view.pixel(keyframes[second]), graph.colour, 1);
  }
  cv::addWeighted(edges, kEdgeOpacity, panel, 1.0 - kEdgeOpacity, 0.0, panel);
  for (const Eigen::Vector3d& keyframe : keyframes) cv::circle(panel, view.pixel(keyframe), 3, kInk, cv::FILLED);
  draw_text(panel, graph.title + ": " + std::to_string(graph.edges.size()) + " edges", {16, 26}, kInk);
  draw_scale_bar(panel, view.pixels_per_metre());
}

/// One square per pair of keyframes, the first keyframe at the top left.
void draw_adjacency(cv::Mat panel, std::size_t keyframes, const PlottedGraph& graph) {
  const int size = std::max(1, static_cast<int>(keyframes));
  cv::Mat matrix(size, size, CV_8UC3, kPaper);
  const cv::Vec3b colour(cv::saturate_cast<std::uint8_t>(graph.colour[0]),
                         cv::saturate_cast<std::uint8_t>(graph.colour[1]),
                         cv::saturate_cast<std::uint8_t>(graph.colour[2]));
  for (const auto& [first, second] : graph.edges) {
    const auto i = static_cast<int>(first);
    const auto j = static_cast<int>(second);
    matrix.at<cv::Vec3b>(i, j) = matrix.at<cv::Vec3b>(j, i) = colour;
  }
  const cv::Rect inside(kMargin, kMargin, panel.cols - 2 * kMargin, panel.rows - 2 * kMargin);
  cv::Mat square = panel(inside);
  cv::resize(matrix, square, square.size(), 0.0, 0.0, cv::INTER_NEAREST);
  cv::rectangle(panel, inside, kFrameColour);
  draw_text(panel, "which keyframes are connected, in order of time", {16, 26}, kInk);
}

}  // namespace

cv::Mat render_graphs(std::span<const Eigen::Vector3d> keyframes, std::span<const PlottedGraph> graphs,
                      const RenderOptions& options) {
  const int count = std::max<int>(1, static_cast<int>(graphs.size()));
  const int side = options.width / count;
  cv::Mat image(2 * side, options.width, CV_8UC3, kPaper);
  for (int i = 0; i < static_cast<int>(graphs.size()); ++i) {
    const PlottedGraph& graph = graphs[static_cast<std::size_t>(i)];
    draw_map(image(cv::Rect(side * i, 0, side, side)), keyframes, graph, options);
    draw_adjacency(image(cv::Rect(side * i, side, side, side)), keyframes.size(), graph);
    cv::rectangle(image, {side * i, 0, side, 2 * side}, kFrameColour);
  }
  return image;
}

}  // namespace eg::eval
