#include "common/egraph/association.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "common/geometry/so3.hpp"

namespace eg::egraph {
namespace {

/// Floor on the variance of a difference of directions (0.01°): exact data must not be rejected for rounding.
constexpr double kMinVariance = 3e-8;

bool same_class(DirectionKind a, DirectionKind b) {
  return (a == DirectionKind::plane_normal) == (b == DirectionKind::plane_normal);
}

/// A direction of the frame turned into the world.
struct TurnedDirection {
  Eigen::Vector3d direction;
  Eigen::Matrix3d covariance;                ///< of the measurement
  Eigen::Matrix3d covariance_with_rotation;  ///< and of the rotation that turned it

  TurnedDirection(const features::DirectionFeature& feature, const Eigen::Matrix3d& world_from_camera,
                  const Eigen::Matrix3d& rotation_covariance)
      : direction(world_from_camera * feature.direction),
        covariance(world_from_camera * feature.covariance * world_from_camera.transpose()),
        covariance_with_rotation(direction_covariance_in_world(feature, world_from_camera, rotation_covariance)) {}
};

/// -2 ln of the likelihood ratio of a chance match, which lies anywhere in the gate of th_vd, to an exact one, which
/// lies within the spread of the measurement.
double chance_chi2(const Eigen::Matrix2d& spread, double max_angle) {
  const double gate = std::numbers::pi * max_angle * max_angle;
  return 2.0 * std::log(gate / (2.0 * std::numbers::pi * std::sqrt(spread.determinant())));
}

Association compare(std::size_t feature, const TurnedDirection& seen, const DirectionLandmark& landmark,
                    double max_angle) {
  const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(landmark.direction);
  const auto spread = [&](const Eigen::Matrix3d& covariance) -> Eigen::Matrix2d {
    return basis.transpose() * (covariance + landmark.covariance) * basis + kMinVariance * Eigen::Matrix2d::Identity();
  };
  const double sign = seen.direction.dot(landmark.direction) < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector2d difference = basis.transpose() * (sign * seen.direction);
  const double chi2 = difference.dot(spread(seen.covariance_with_rotation).inverse() * difference);
  return {feature, landmark.id, sign, chi2, chance_chi2(spread(seen.covariance), max_angle)};
}

/// `landmarks`: those that may be meant.
void add_candidates(std::size_t feature, DirectionKind kind, const TurnedDirection& seen,
                    std::span<const DirectionLandmark* const> landmarks, const AssociationOptions& options,
                    std::vector<Association>& found) {
  const double min_cosine = std::cos(options.max_angle);
  const std::size_t first = found.size();
  int chances = 0;
  for (const DirectionLandmark* landmark : landmarks) {
    if (!same_class(kind, landmark->kind)) continue;
    if (std::abs(seen.direction.dot(landmark->direction)) < min_cosine) continue;
    ++chances;
    const Association candidate = compare(feature, seen, *landmark, options.max_angle);
    if (candidate.chi2 < options.max_chi2) found.push_back(candidate);
  }
  for (Association& candidate : std::span(found).subspan(first)) {
    candidate.outlier_chi2 = std::max(0.0, candidate.outlier_chi2 - 2.0 * std::log(chances));
  }
}

/// Of each feature's candidates, which stand together, the one that fits best.
std::vector<Association> best_of_each(std::span<const Association> candidates) {
  std::vector<Association> best;
  for (const Association& candidate : candidates) {
    if (best.empty() || best.back().feature != candidate.feature) {
      best.push_back(candidate);
    } else if (candidate.chi2 < best.back().chi2) {
      best.back() = candidate;
    }
  }
  return best;
}

}  // namespace

Eigen::Matrix3d direction_covariance_in_world(const features::DirectionFeature& feature,
                                              const Eigen::Matrix3d& world_from_camera,
                                              const Eigen::Matrix3d& rotation_covariance) {
  const Eigen::Matrix3d lever = geometry::hat(world_from_camera * feature.direction);
  return world_from_camera * feature.covariance * world_from_camera.transpose() +
         lever * rotation_covariance * lever.transpose();
}

std::vector<Association> candidates(std::span<const features::DirectionFeature> directions, const Graph& graph,
                                    const Eigen::Matrix3d& world_from_camera,
                                    const Eigen::Matrix3d& rotation_covariance, const AssociationOptions& options) {
  std::vector<Association> found;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const TurnedDirection seen(directions[i], world_from_camera, rotation_covariance);
    std::vector<const DirectionLandmark*> near = graph.landmarks_near(seen.direction, options.max_angle);
    std::erase_if(near, [](const DirectionLandmark* l) { return l->kind == DirectionKind::potential_direction; });
    add_candidates(i, directions[i].kind, seen, near, options, found);
  }
  return found;
}

std::vector<Association> associate(std::span<const features::DirectionFeature> directions, const Graph& graph,
                                   const Eigen::Matrix3d& world_from_camera, const Eigen::Matrix3d& rotation_covariance,
                                   const AssociationOptions& options) {
  return best_of_each(candidates(directions, graph, world_from_camera, rotation_covariance, options));
}

std::optional<Association> associate(const features::DirectionFeature& direction,
                                     std::span<const DirectionLandmark> landmarks,
                                     const Eigen::Matrix3d& world_from_camera,
                                     const Eigen::Matrix3d& rotation_covariance, const AssociationOptions& options) {
  const TurnedDirection seen(direction, world_from_camera, rotation_covariance);
  std::vector<const DirectionLandmark*> all;
  for (const DirectionLandmark& landmark : landmarks) all.push_back(&landmark);
  std::vector<Association> found;
  add_candidates(0, direction.kind, seen, all, options, found);
  found = best_of_each(found);
  return found.empty() ? std::nullopt : std::optional(found.front());
}

}  // namespace eg::egraph
