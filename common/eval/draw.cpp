#include "common/eval/draw.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace eg::eval {
namespace {

constexpr double kFontScale = 0.5;
const cv::Scalar kInk(60, 60, 60);
// cv::line() takes fixed-point coordinates: finer than a pixel, yet far from overflow.
constexpr int kSubpixelBits = 4;
constexpr double kFarthestPixel = 1e5;

cv::Point fixed_point(const cv::Point2d& pixel) {
  const auto convert = [](double value) {
    return static_cast<int>(std::lround(std::clamp(value, -kFarthestPixel, kFarthestPixel) * (1 << kSubpixelBits)));
  };
  return {convert(pixel.x), convert(pixel.y)};
}

}  // namespace

std::vector<Eigen::Vector3d> points_of(std::span<const Path> paths) {
  std::vector<Eigen::Vector3d> points;
  for (const Path& path : paths) points.insert(points.end(), path.points.begin(), path.points.end());
  return points;
}

void draw_line(cv::Mat& image, const cv::Point2d& from, const cv::Point2d& to, const cv::Scalar& colour,
               int thickness) {
  cv::line(image, fixed_point(from), fixed_point(to), colour, thickness, cv::LINE_AA, kSubpixelBits);
}

void draw_path(cv::Mat& image, const Path& path, const OrthographicView& view, int thickness) {
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    draw_line(image, view.pixel(path.points[i - 1]), view.pixel(path.points[i]), path.colour, thickness);
  }
}

void draw_text(cv::Mat& image, const std::string& text, const cv::Point& left_baseline, const cv::Scalar& colour) {
  cv::putText(image, text, left_baseline, cv::FONT_HERSHEY_SIMPLEX, kFontScale, colour, 1, cv::LINE_AA);
}

void draw_legend(cv::Mat& image, std::span<const Path> paths) {
  constexpr int kLeft = 16, kTop = 24, kLineHeight = 22, kSwatch = 28;
  int y = kTop;
  for (const Path& path : paths) {
    draw_line(image, cv::Point2d(kLeft, y - 5), cv::Point2d(kLeft + kSwatch, y - 5), path.colour, 3);
    draw_text(image, path.label, {kLeft + kSwatch + 8, y}, kInk);
    y += kLineHeight;
  }
}

void draw_scale_bar(cv::Mat& image, double pixels_per_metre) {
  constexpr int kMargin = 16;
  double metres = 0.01;
  // 1, 2, 5, 10, 20, 50, ... cm: the longest that takes at most a quarter of the picture.
  for (const double step : {0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0}) {
    if (step * pixels_per_metre <= 0.25 * image.cols) metres = step;
  }
  const double y = image.rows - kMargin;
  draw_line(image, {kMargin, y}, {kMargin + metres * pixels_per_metre, y}, kInk, 2);
  const std::string label =
      metres < 1.0 ? std::to_string(std::lround(100 * metres)) + " cm" : std::to_string(std::lround(metres)) + " m";
  draw_text(image, label, {kMargin, image.rows - kMargin - 8}, kInk);
}

}  // namespace eg::eval
