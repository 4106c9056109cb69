#include "common/features/plane_hull.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "common/features/plane_tolerance.hpp"
#include "common/geometry/so3.hpp"

namespace eg::features {
namespace {

/// The leftmost and rightmost pixel of every label in every row: they hold every corner of the hulls.
std::vector<std::vector<cv::Point>> row_ends(const cv::Mat& labels, std::size_t count) {
  std::vector<std::vector<cv::Point>> ends(count);
  for (int v = 0; v < labels.rows; ++v) {
    const auto* label = labels.ptr<std::uint8_t>(v);
    for (int begin = 0; begin < labels.cols;) {
      int end = begin + 1;
      while (end < labels.cols && label[end] == label[begin]) ++end;
      if (label[begin] > 0) {
        auto& points = ends[label[begin] - 1U];
        if (points.empty() || points.back().y != v) {
          points.emplace_back(begin, v);
          points.emplace_back(begin, v);
        }
        points.back().x = end - 1;
      }
      begin = end;
    }
  }
  return ends;
}

/// Where a pixel's ray meets the plane, as inverse depth: at the reading, give or take its noise. Where a ray runs
/// nearly along the plane they meet far away or behind the camera, and the reading knows better.
double inverse_depth_on(const geometry::Plane& plane, const Eigen::Vector3d& ray, double reading) {
  const double noise = 3.0 * inverse_depth_sigma(reading);
  return std::clamp(plane.normal.dot(ray) / -plane.distance, std::max(0.5 * reading, reading - noise), reading + noise);
}

double corner_area(const std::vector<cv::Point2f>& hull, std::size_t corner) {
  const cv::Point2f before = hull[(corner + hull.size() - 1) % hull.size()] - hull[corner];
  const cv::Point2f after = hull[(corner + 1) % hull.size()] - hull[corner];
  return std::abs(before.cross(after));
}

/// Cuts the corners off that matter least (Visvalingam and Whyatt, Cartographic Journal 1993). The result lies inside.
void simplify(std::vector<cv::Point2f>& hull, std::size_t max_points) {
  while (hull.size() > max_points) {
    std::size_t least = 0;
    double least_area = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const double area = corner_area(hull, i);
      if (area < least_area) {
        least = i;
        least_area = area;
      }
    }
    hull.erase(hull.begin() + static_cast<std::ptrdiff_t>(least));
  }
}

}  // namespace

void add_hulls(const cv::Mat& labels, const BlockGrid& grid, std::vector<PlaneFeature>& planes) {
  const auto ends = row_ends(labels, planes.size());
  std::vector<cv::Point2f> points, hull;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    PlaneFeature& feature = planes[i];
    const Eigen::Matrix<double, 3, 2> axes = geometry::tangent_basis(feature.plane.normal);
    points.clear();
    for (const cv::Point& pixel : ends[i]) {
      const Eigen::Vector3d ray(grid.ray_x[static_cast<std::size_t>(pixel.x)],
                                grid.ray_y[static_cast<std::size_t>(pixel.y)], 1.0);
      const double inverse_depth = inverse_depth_on(feature.plane, ray, grid.inverse_depth.at<float>(pixel));
      const Eigen::Vector2d on_plane = axes.transpose() * (ray / inverse_depth - feature.centroid);
      points.emplace_back(static_cast<float>(on_plane.x()), static_cast<float>(on_plane.y()));
    }
    cv::convexHull(points, hull);
    simplify(hull, kMaxHullPoints);
    for (const cv::Point2f& corner : hull) {
      feature.hull.push_back(feature.centroid + axes * Eigen::Vector2d(corner.x, corner.y));
    }
  }
}

}  // namespace eg::features
