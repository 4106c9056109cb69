#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "common/base/random.hpp"
#include "common/geometry/camera_model.hpp"
#include "common/geometry/depth_noise.hpp"
#include "common/geometry/plane.hpp"

namespace eg::test {

/// Depth images of analytic planes, for tests that need to know which pixel shows which plane.
struct PlaneScene {
  geometry::CameraModel camera;
  std::vector<geometry::Plane> planes;  ///< camera frame, normals towards the camera; the nearest in front is seen

  /// Index of the plane seen at a pixel and its depth; -1 and infinity if there is none.
  [[nodiscard]] std::pair<int, double> hit(int u, int v) const {
    const Eigen::Vector3d ray = camera.ray({u, v});
    std::pair<int, double> nearest{-1, std::numeric_limits<double>::infinity()};
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const double depth = -planes[i].distance / planes[i].normal.dot(ray);
      if (depth > 0 && depth < nearest.second) nearest = {static_cast<int>(i), depth};
    }
    return nearest;
  }

  /// Exact depth, CV_32FC1, metres.
  [[nodiscard]] cv::Mat depth() const {
    cv::Mat image(camera.height, camera.width, CV_32FC1);
    for (int v = 0; v < image.rows; ++v) {
      for (int u = 0; u < image.cols; ++u) {
        const auto [plane, z] = hit(u, v);
        image.at<float>(v, u) = plane < 0 ? 0.0F : static_cast<float>(z);
      }
    }
    return image;
  }
};

inline geometry::CameraModel vga_camera(double fy = 525.0) {
  geometry::CameraModel camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 525.0;
  camera.fy = fy;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.depth_units_per_metre = 5000;
  camera.fps = 30;
  return camera;
}

/// The plane through `point` whose normal is parallel to `normal`, turned towards the camera.
inline geometry::Plane plane_through(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  Eigen::Vector3d n = normal.normalized();
  if (n.dot(point) > 0) n = -n;
  return {n, -n.dot(point)};
}

/// A reading at depth z whose disparity, and so inverse depth, is off by `error` standard deviations of the sensor.
inline double noisy_depth(double z, double error) {
  return 1.0 / (1.0 / z + error * geometry::depth_sigma(z) / (z * z));
}

/// Adds the sensor's noise, independent from pixel to pixel.
inline void add_white_noise(cv::Mat& depth, base::Random& random) {
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      float& z = depth.at<float>(v, u);
      if (z > 0) z = static_cast<float>(noisy_depth(z, random.normal()));
    }
  }
}

/// Adds the sensor's noise as structured light makes it: found by matching a window of `window` (odd) pixels, so that
/// neighbours share it, and rounded to 1/8 pixel of disparity.
inline void add_correlated_noise(cv::Mat& depth, base::Random& random, int window) {
  constexpr double kStepsPerInverseMetre = 8 * 43.5;  // focal length times baseline of the first Kinect, pixel metres
  cv::Mat noise(depth.rows, depth.cols, CV_64FC1);
  for (int v = 0; v < noise.rows; ++v) {
    for (int u = 0; u < noise.cols; ++u) noise.at<double>(v, u) = random.normal() * window;
  }
  cv::blur(noise, noise, {window, window}, {-1, -1}, cv::BORDER_REFLECT_101);
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      float& z = depth.at<float>(v, u);
      if (z <= 0) continue;
      const double disparity = kStepsPerInverseMetre / noisy_depth(z, noise.at<double>(v, u));
      z = static_cast<float>(kStepsPerInverseMetre / std::round(disparity));
    }
  }
}

}  // namespace eg::test
