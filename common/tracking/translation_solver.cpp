#include "common/tracking/translation_solver.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>

#include "common/base/random.hpp"

namespace eg::tracking {
namespace {

/// Smallest eigenvalue of the normal matrix, in 1/m², that counts as determined: a standard deviation of one metre.
constexpr double kMinInformation = 1.0;

/// Adds weight (a·t - b)² to the normal equations.
void add_equation(const Eigen::Vector3d& a, double b, double sigma, Eigen::Matrix3d& normal, Eigen::Vector3d& right) {
  const double weight = 1.0 / (sigma * sigma);
  normal += weight * a * a.transpose();
  right += weight * b * a;
}

}  // namespace

std::optional<Eigen::Vector3d> solve_translation(std::span<const PointFactor> factors,
                                                 const geometry::CameraModel& camera,
                                                 const Eigen::Matrix3d& camera_from_world_rotation) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const PointFactor& factor : factors) {
    // With q = R P and the ray (x, y, 1): (q_x + t_x) - x (q_z + t_z) = 0, likewise for y. In metres at the point's
    // range.
    const Eigen::Vector3d q = camera_from_world_rotation * factor.point_in_world;
    const Eigen::Vector3d ray = camera.ray(factor.pixel);
    const double range = factor.depth > 0.0 ? factor.depth : 2.0;
    const double sigma = factor.pixel_sigma * range / camera.fx;
    add_equation({1.0, 0.0, -ray.x()}, ray.x() * q.z() - q.x(), sigma, normal, right);
    add_equation({0.0, 1.0, -ray.y()}, ray.y() * q.z() - q.y(), sigma, normal, right);
    if (factor.depth > 0.0)
      add_equation(Eigen::Vector3d::UnitZ(), factor.depth - q.z(), factor.depth_sigma, normal, right);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(normal, Eigen::EigenvaluesOnly);
  if (!(eigen.eigenvalues()[0] > kMinInformation)) return std::nullopt;
  return normal.inverse() * right;
}

std::optional<TranslationEstimate> estimate_translation(std::span<const PointFactor> factors,
                                                        const geometry::CameraModel& camera,
                                                        const Eigen::Matrix3d& camera_from_world_rotation,
                                                        const TranslationOptions& options) {
  if (factors.size() < 2) return std::nullopt;
  base::Random random(options.seed);
  TranslationEstimate best;
  for (int sample = 0; sample < options.samples; ++sample) {
    const int first = random.index(static_cast<int>(factors.size()));
    const int second = random.index(static_cast<int>(factors.size()));
    if (first == second) continue;
    const std::array<PointFactor, 2> couple = {factors[static_cast<std::size_t>(first)],
                                               factors[static_cast<std::size_t>(second)]};
    const auto translation = solve_translation(couple, camera, camera_from_world_rotation);
    if (!translation) continue;
    TranslationEstimate candidate{*translation, std::vector<bool>(factors.size(), false), 0};
    const geometry::Pose pose{camera_from_world_rotation, *translation};
    for (std::size_t i = 0; i < factors.size(); ++i) {
      candidate.inliers[i] = reprojection_chi2(factors[i], camera, pose) < options.inlier_chi2;
      candidate.inlier_count += candidate.inliers[i] ? 1 : 0;
    }
    if (candidate.inlier_count > best.inlier_count) best = candidate;
  }
  if (best.inlier_count < options.min_inliers) return std::nullopt;

  std::vector<PointFactor> agreeing;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    if (best.inliers[i]) agreeing.push_back(factors[i]);
  }
  if (const auto refined = solve_translation(agreeing, camera, camera_from_world_rotation)) best.translation = *refined;
  return best;
}

}  // namespace eg::tracking
