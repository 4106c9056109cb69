#include "common/egraph/association.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/so3.hpp"

namespace eg::egraph {
namespace {

/// Floor on the variance of a difference of directions (0.01°): exact data must not be rejected for rounding.
constexpr double kMinVariance = 3e-8;

bool same_class(DirectionKind a, DirectionKind b) {
  return (a == DirectionKind::plane_normal) == (b == DirectionKind::plane_normal);
}

/// -2 ln of the likelihood ratio of a chance match to an exact one: `candidates` landmarks lie anywhere in the gate of
/// th_vd, the true one within the spread of the measurement.
double chance_chi2(int candidates, const Eigen::Matrix2d& spread, double max_angle) {
  const double gate = std::numbers::pi * max_angle * max_angle;
  const double ellipse = 2.0 * std::numbers::pi * std::sqrt(spread.determinant());
  return std::max(0.0, 2.0 * std::log(gate / (candidates * ellipse)));
}

}  // namespace

Eigen::Matrix3d direction_covariance_in_world(const features::DirectionFeature& feature,
                                              const Eigen::Matrix3d& world_from_camera,
                                              const Eigen::Matrix3d& rotation_covariance) {
  const Eigen::Matrix3d lever = geometry::hat(world_from_camera * feature.direction);
  return world_from_camera * feature.covariance * world_from_camera.transpose() +
         lever * rotation_covariance * lever.transpose();
}

std::vector<Association> associate(std::span<const features::DirectionFeature> directions,
                                   std::span<const DirectionLandmark> landmarks,
                                   const Eigen::Matrix3d& world_from_camera, const Eigen::Matrix3d& rotation_covariance,
                                   const AssociationOptions& options) {
  const double min_cosine = std::cos(options.max_angle);
  std::vector<Association> associations;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const features::DirectionFeature& feature = directions[i];
    const Eigen::Vector3d in_world = world_from_camera * feature.direction;
    const Eigen::Matrix3d measured = world_from_camera * feature.covariance * world_from_camera.transpose();
    const Eigen::Matrix3d covariance = direction_covariance_in_world(feature, world_from_camera, rotation_covariance);
    Association best{i, {}, 1.0, 0.0};
    double best_chi2 = options.max_chi2;
    Eigen::Matrix2d best_spread = Eigen::Matrix2d::Identity();
    int candidates = 0;
    for (const DirectionLandmark& landmark : landmarks) {
      const double cosine = in_world.dot(landmark.direction);
      if (std::abs(cosine) < min_cosine || !same_class(feature.kind, landmark.kind)) continue;
      ++candidates;
      const double sign = cosine < 0.0 ? -1.0 : 1.0;
      const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(landmark.direction);
      const Eigen::Vector2d difference = basis.transpose() * (sign * in_world);
      const Eigen::Matrix2d spread =
          basis.transpose() * (covariance + landmark.covariance) * basis + kMinVariance * Eigen::Matrix2d::Identity();
      const double chi2 = difference.dot(spread.inverse() * difference);
      if (chi2 < best_chi2) {
        best_chi2 = chi2;
        best.landmark = landmark.id;
        best.sign = sign;
        best_spread =
            basis.transpose() * (measured + landmark.covariance) * basis + kMinVariance * Eigen::Matrix2d::Identity();
      }
    }
    if (!best.landmark.valid()) continue;
    best.outlier_chi2 = chance_chi2(candidates, best_spread, options.max_angle);
    associations.push_back(best);
  }
  return associations;
}

}  // namespace eg::egraph
