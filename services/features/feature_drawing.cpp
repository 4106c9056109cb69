#include "services/features/feature_drawing.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace eg::features_tool {
namespace {

using features::DirectionKind;
using features::FrameFeatures;

/// Colours that are easy to tell apart: hues a golden angle from each other.
cv::Scalar colour_of(int index, double saturation = 255.0) {
  const double hue = std::fmod(90.0 + index * 68.754, 180.0);
  cv::Mat pixel(1, 1, CV_8UC3, cv::Scalar(hue, saturation, 255.0));
  cv::cvtColor(pixel, pixel, cv::COLOR_HSV2BGR);
  const auto bgr = pixel.at<cv::Vec3b>(0, 0);
  return {static_cast<double>(bgr[0]), static_cast<double>(bgr[1]), static_cast<double>(bgr[2])};
}

constexpr int kSubPixelBits = 4;

cv::Point sub_pixel(const Eigen::Vector2d& pixel) {
  constexpr double kScale = 1 << kSubPixelBits;
  return {cvRound(pixel.x() * kScale), cvRound(pixel.y() * kScale)};
}

void tint_planes(cv::Mat& canvas, const cv::Mat& labels, const FrameFeatures& features) {
  constexpr double kOpacity = 0.35;
  cv::Mat tint = canvas.clone();
  for (std::size_t i = 0; i < features.planes.size(); ++i) {
    tint.setTo(colour_of(static_cast<int>(i) + 5, 160.0), labels == static_cast<int>(i) + 1);
  }
  cv::addWeighted(tint, kOpacity, canvas, 1.0 - kOpacity, 0.0, canvas);
}

void draw_points(cv::Mat& canvas, const FrameFeatures& features) {
  for (const features::PointFeature& point : features.points) {
    const cv::Scalar colour = point.has_depth() ? cv::Scalar(0, 255, 0) : cv::Scalar(0, 0, 255);
    const double radius = 2.0 * point.pixel_sigma;
    const Eigen::Vector2d tip = point.pixel + radius * Eigen::Vector2d(std::cos(point.angle), std::sin(point.angle));
    cv::circle(canvas, sub_pixel(point.pixel), cvRound(radius * (1 << kSubPixelBits)), colour, 1, cv::LINE_AA,
               kSubPixelBits);
    cv::line(canvas, sub_pixel(point.pixel), sub_pixel(tip), colour, 1, cv::LINE_AA, kSubPixelBits);
  }
}

cv::Scalar line_colour(const features::LineFeature& line, const FrameFeatures& features) {
  constexpr double kGrey = 150.0;
  if (line.direction < 0) return cv::Scalar::all(kGrey);
  const auto& direction = features.directions[static_cast<std::size_t>(line.direction)];
  if (direction.kind == DirectionKind::potential_direction) return cv::Scalar::all(255.0);
  return colour_of(line.direction - static_cast<int>(features.planes.size()));
}

void draw_lines(cv::Mat& canvas, const FrameFeatures& features) {
  for (const features::LineFeature& line : features.lines) {
    cv::line(canvas, sub_pixel(line.start_pixel), sub_pixel(line.end_pixel), line_colour(line, features),
             line.has_depth ? 2 : 1, cv::LINE_AA, kSubPixelBits);
  }
}

/// The vanishing directions as arrows from a common origin, as if seen from the camera.
void draw_compass(cv::Mat& canvas, const FrameFeatures& features) {
  const double size = 0.08 * canvas.rows;
  const Eigen::Vector2d origin(1.3 * size, canvas.rows - 1.3 * size);
  const double flip = features.camera.fy < 0.0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < features.directions.size(); ++i) {
    const auto& direction = features.directions[i];
    if (direction.kind != DirectionKind::vanishing_direction) continue;
    const Eigen::Vector2d tip =
        origin + size * Eigen::Vector2d(direction.direction.x(), flip * direction.direction.y());
    const int group = static_cast<int>(i - features.planes.size());
    cv::line(canvas, sub_pixel(origin), sub_pixel(tip), colour_of(group), 3, cv::LINE_AA, kSubPixelBits);
  }
}

}  // namespace

cv::Mat draw_features(const cv::Mat& colour, const cv::Mat& plane_labels, const features::FrameFeatures& features) {
  cv::Mat canvas = colour.clone();
  if (canvas.empty()) return canvas;
  tint_planes(canvas, plane_labels, features);
  draw_points(canvas, features);
  draw_lines(canvas, features);
  draw_compass(canvas, features);
  return canvas;
}

}  // namespace eg::features_tool
