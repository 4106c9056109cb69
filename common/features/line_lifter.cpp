#include "common/features/line_lifter.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "common/features/line_inverse_depth.hpp"

namespace eg::features {
namespace {

constexpr double kMinInverseDepth = 0.05;  // 1/m: nothing indoors is farther than 20 m

/// What one end point's noise comes from: its inverse depth, the pixel across the segment, the pixel along it.
Eigen::Matrix3d end_covariance(const Eigen::Vector3d& point, double inverse_depth_variance, const Segment& segment,
                               const Eigen::Vector3d& along_per_pixel, const geometry::CameraModel& camera,
                               double slide_sigma) {
  const double z = point.z();
  const Eigen::Vector3d by_inverse_depth = -z * point;  // d(ray / w) / dw = -ray / w²
  const Eigen::Vector2d normal = segment.normal();
  const Eigen::Vector3d by_pixel(z * normal.x() / camera.fx, z * normal.y() / camera.fy, 0.0);
  return inverse_depth_variance * by_inverse_depth * by_inverse_depth.transpose() +
         segment.sigma * segment.sigma * by_pixel * by_pixel.transpose() +
         slide_sigma * slide_sigma * along_per_pixel * along_per_pixel.transpose();
}

}  // namespace

std::optional<LiftedLine> lift_line(const Segment& segment, const cv::Mat& depth, const geometry::CameraModel& camera,
                                    const LineLifterOptions& options, std::uint64_t seed) {
  const auto fit = fit_inverse_depth(sample_line_depth(depth, segment), options, seed);
  if (!fit) return std::nullopt;

  const Eigen::RowVector2d start_row(1.0, -1.0);
  const Eigen::RowVector2d end_row(1.0, 1.0);
  const double start_inverse = fit->at(-1.0);
  const double end_inverse = fit->at(1.0);
  const double start_variance = start_row * fit->covariance * start_row.transpose();
  const double end_variance = end_row * fit->covariance * end_row.transpose();
  if (start_inverse < kMinInverseDepth || end_inverse < kMinInverseDepth) return std::nullopt;
  if (std::sqrt(start_variance) > options.max_relative_sigma * start_inverse) return std::nullopt;
  if (std::sqrt(end_variance) > options.max_relative_sigma * end_inverse) return std::nullopt;

  const Eigen::Vector3d start_ray = camera.ray(segment.start);
  const Eigen::Vector3d end_ray = camera.ray(segment.end);
  LiftedLine line;
  line.start = start_ray / start_inverse;
  line.end = end_ray / end_inverse;
  const Eigen::Vector3d span = line.end - line.start;
  if (span.norm() < 1e-6) return std::nullopt;
  line.direction = span.normalized();

  // Turning within the interpretation plane, per change of the two inverse depths.
  const Eigen::Vector3d plane_normal = start_ray.cross(end_ray).normalized();
  const Eigen::Vector3d sideways = plane_normal.cross(line.direction) / span.norm();
  const Eigen::RowVector2d turn =
      sideways.dot(line.start) * line.start.z() * start_row - sideways.dot(line.end) * line.end.z() * end_row;
  const double turn_variance = turn * fit->covariance * turn.transpose();
  line.direction_sigma = std::hypot(std::sqrt(turn_variance), options.direction_sigma_floor);

  // An end point that slides one pixel: a share of the length in the image, more of it in space where the line is far.
  const Eigen::Vector3d per_pixel = span / segment.length();
  const Eigen::Vector3d start_per_pixel = per_pixel * (line.start.z() / line.end.z());
  const Eigen::Vector3d end_per_pixel = per_pixel * (line.end.z() / line.start.z());
  line.start_covariance =
      end_covariance(line.start, start_variance, segment, start_per_pixel, camera, options.end_slide_sigma);
  line.end_covariance = end_covariance(line.end, end_variance, segment, end_per_pixel, camera, options.end_slide_sigma);
  return line;
}

}  // namespace eg::features
