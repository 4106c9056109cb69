#include "common/mapping/plane_in_image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace eg::mapping {
namespace {

constexpr double kUnitTolerance = 1e-3;  // of a normal's length
constexpr std::size_t kMinCorners = 3;

bool is_sound(const DepthPlane& plane) {
  return plane.plane.normal.allFinite() && std::abs(plane.plane.normal.norm() - 1.0) < kUnitTolerance &&
         std::isfinite(plane.plane.distance) && plane.plane.distance > 0.0 && plane.covariance.allFinite() &&
         plane.support > 0.0 && plane.hull.size() >= kMinCorners;
}

/// From (normal, distance) to the coefficients: the ray of a pixel is r = T (u, v, 1), and on the plane
/// 1/z = g · r with g = -normal / distance.
void set_coefficients(const DepthPlane& plane, const geometry::CameraModel& camera, PlaneInImage& in_image) {
  Eigen::Matrix3d ray_from_pixel;
  ray_from_pixel << 1.0 / camera.fx, 0.0, -camera.cx / camera.fx, 0.0, 1.0 / camera.fy, -camera.cy / camera.fy, 0.0,
      0.0, 1.0;
  const double distance = plane.plane.distance;
  Eigen::Matrix<double, 3, 4> gradient_by_plane;
  gradient_by_plane << -Eigen::Matrix3d::Identity() / distance, plane.plane.normal / (distance * distance);
  const Eigen::Matrix<double, 3, 4> jacobian = ray_from_pixel.transpose() * gradient_by_plane;
  in_image.coefficients = ray_from_pixel.transpose() * (-plane.plane.normal / distance);
  in_image.covariance = jacobian * plane.covariance * jacobian.transpose();
}

/// Pixels of the hull's corners; none if one is not before the camera, or the plane is not there.
std::vector<Eigen::Vector2d> corners_of(const DepthPlane& plane, const geometry::CameraModel& camera,
                                        const PlaneInImage& in_image) {
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector3d& point : plane.hull) {
    const Eigen::Vector2d pixel = camera.project(point);
    // The inverse depth is linear: positive at all corners, it is so in between.
    if (!(point.z() > 0.0) || !pixel.allFinite() || !(in_image.inverse_depth(pixel.x(), pixel.y()) > 0.0)) return {};
    corners.push_back(pixel);
  }
  return corners;
}

/// Columns of one row inside the polygon.
PlaneInImage::Span span_of_row(const std::vector<Eigen::Vector2d>& corners, int row, int width) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  const auto add = [&](double column) {
    low = std::min(low, column);
    high = std::max(high, column);
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& from = corners[i];
    const Eigen::Vector2d& to = corners[(i + 1) % corners.size()];
    if (std::min(from.y(), to.y()) > row || std::max(from.y(), to.y()) < row) continue;
    if (from.y() == to.y()) {
      add(from.x());
      add(to.x());
    } else {
      add(from.x() + (to.x() - from.x()) * (row - from.y()) / (to.y() - from.y()));
    }
  }
  const double begin = std::ceil(std::max(low, 0.0));
  const double last = std::floor(std::min(high, width - 1.0));
  if (!(begin <= last)) return {};
  return {static_cast<int>(begin), static_cast<int>(last) + 1};
}

}  // namespace

std::optional<PlaneInImage> project(const DepthPlane& plane, const geometry::CameraModel& camera) {
  if (!is_sound(plane)) return std::nullopt;
  PlaneInImage in_image;
  in_image.support = plane.support;
  set_coefficients(plane, camera, in_image);
  const std::vector<Eigen::Vector2d> corners = corners_of(plane, camera, in_image);
  if (corners.empty()) return std::nullopt;
  const auto [top, bottom] = std::minmax_element(
      corners.begin(), corners.end(), [](const auto& left, const auto& right) { return left.y() < right.y(); });
  const double first = std::ceil(std::max(top->y(), 0.0));
  const double last = std::floor(std::min(bottom->y(), camera.height - 1.0));
  if (!(first <= last)) return std::nullopt;
  in_image.first_row = static_cast<int>(first);
  bool is_seen = false;
  for (int row = in_image.first_row; row <= static_cast<int>(last); ++row) {
    in_image.spans.push_back(span_of_row(corners, row, camera.width));
    is_seen = is_seen || in_image.spans.back().begin < in_image.spans.back().end;
  }
  return is_seen ? std::optional(std::move(in_image)) : std::nullopt;
}

}  // namespace eg::mapping
