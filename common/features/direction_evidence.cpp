#include "common/features/direction_evidence.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/geometry/so3.hpp"

namespace eg::features {
namespace {

constexpr double kCauchyScale = 2.5;  // standard deviations

/// Sums over the evidence at a direction.
struct Normal {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double weighted_squares = 0.0;
  int measurements = 0;

  void add(const Eigen::Vector3d& axis, double sigma, const Eigen::Vector3d& direction) {
    const double residual = axis.dot(direction) / sigma;
    const double weight = 1.0 / (1.0 + residual * residual / (kCauchyScale * kCauchyScale));
    information += weight / (sigma * sigma) * axis * axis.transpose();
    weighted_squares += weight * residual * residual;
    ++measurements;
  }
};

Normal accumulate(const std::vector<const DirectionEvidence*>& evidence, const Eigen::Vector3d& direction) {
  Normal normal;
  for (const DirectionEvidence* line : evidence) {
    normal.add(line->segment.plane_normal, line->normal_sigma(direction), direction);
    if (line->has_depth) normal.add(line->sideways, line->sideways_sigma, direction);
  }
  return normal;
}

}  // namespace

double DirectionEvidence::normal_sigma(const Eigen::Vector3d& v) const {
  // A line fitted to points along the segment: its offset is uncorrelated with its slope, and at the ends the slope
  // brings three quarters of the variance.
  const double by_shift = 0.5 * pixel_sigma * shift.dot(v);
  const double by_turn = std::sqrt(0.75) * pixel_sigma * turn.dot(v);
  return std::sqrt(by_shift * by_shift + by_turn * by_turn + kStraightness * kStraightness);
}

DirectionEvidence make_evidence(const MeasuredLine& line, const geometry::CameraModel& camera) {
  DirectionEvidence evidence;
  evidence.segment = directional(line.segment, camera);
  evidence.pixel_sigma = line.segment.sigma;
  evidence.length = line.segment.length();

  const Eigen::Vector3d start = camera.ray(line.segment.start);
  const Eigen::Vector3d end = camera.ray(line.segment.end);
  const Eigen::Vector2d across = line.segment.normal();
  const Eigen::Vector3d pixel(across.x() / camera.fx, across.y() / camera.fy, 0.0);
  const double norm = start.cross(end).norm();
  const Eigen::Vector3d by_start = pixel.cross(end) / norm;
  const Eigen::Vector3d by_end = start.cross(pixel) / norm;
  evidence.shift = by_start + by_end;
  evidence.turn = by_end - by_start;

  evidence.has_depth = line.feature.has_depth;
  if (evidence.has_depth) {
    evidence.direction = line.direction;
    evidence.sideways = evidence.segment.plane_normal.cross(line.direction).normalized();
    evidence.sideways_sigma = line.direction_sigma;
  }
  return evidence;
}

double DirectionEstimate::max_sigma() const {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[2]));
}

std::optional<DirectionEstimate> fit_direction(const std::vector<const DirectionEvidence*>& evidence,
                                               const Eigen::Vector3d& initial) {
  constexpr int kIterations = 4;
  Eigen::Vector3d direction = initial.normalized();
  for (int i = 0; i < kIterations; ++i) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(accumulate(evidence, direction).information);
    const Eigen::Vector3d next = solver.eigenvectors().col(0);
    direction = next.dot(direction) < 0.0 ? Eigen::Vector3d(-next) : next;
  }

  const Normal normal = accumulate(evidence, direction);
  if (normal.measurements < 2) return std::nullopt;
  const auto tangent = geometry::tangent_basis(direction);
  const Eigen::Matrix2d information = tangent.transpose() * normal.information * tangent;
  constexpr double kLeastInformation = 1.0;  // 1/rad²: a radian is no direction
  const double determinant = information.determinant();
  if (!(determinant > kLeastInformation * information.trace())) return std::nullopt;

  constexpr double kPriorMeasurements = 2.0;
  const double scatter =
      (kPriorMeasurements + normal.weighted_squares) / (kPriorMeasurements + std::max(0, normal.measurements - 2));
  const Eigen::Matrix2d covariance = std::max(1.0, scatter) * information.inverse();
  return DirectionEstimate{direction, tangent * covariance * tangent.transpose()};
}

}  // namespace eg::features
