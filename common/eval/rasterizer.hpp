#pragma once

#include <array>
#include <opencv2/core/mat.hpp>

namespace eg::eval {

/// A corner of a triangle in the picture.
struct RasterVertex {
  cv::Point2d pixel;
  double depth = 0.0;  ///< smaller is nearer
  cv::Vec3f colour;    ///< BGR, 0 to 255
};

/// Draws triangles with a depth buffer (Catmull 1974) and colours interpolated between their corners (Gouraud 1971).
class Rasterizer {
 public:
  Rasterizer(cv::Size size, const cv::Vec3b& background);

  void draw(const std::array<RasterVertex, 3>& triangle);

  [[nodiscard]] const cv::Mat& image() const { return image_; }  ///< CV_8UC3, BGR

 private:
  cv::Mat3b image_;
  cv::Mat1f depth_;
};

}  // namespace eg::eval
