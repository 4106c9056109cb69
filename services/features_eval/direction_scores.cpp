#include "services/features_eval/direction_scores.hpp"

#include <fmt/core.h>

#include <Eigen/LU>
#include <numbers>

#include "common/eval/statistics.hpp"
#include "common/geometry/so3.hpp"

namespace eg::features_eval {

void DirectionErrors::add(const Eigen::Vector3d& found, const Eigen::Vector3d& truth,
                          const Eigen::Matrix3d& covariance) {
  angles_deg.push_back(geometry::axial_angle(found, truth) * 180.0 / std::numbers::pi);
  const auto tangent = geometry::tangent_basis(found);
  const Eigen::Vector2d error = tangent.transpose() * (truth.dot(found) < 0.0 ? -truth : truth);
  const Eigen::Matrix2d reduced = tangent.transpose() * covariance * tangent;
  constexpr double kDegreesOfFreedom = 2.0;
  squared_by_sigma.push_back(error.dot(reduced.inverse() * error) / kDegreesOfFreedom);
}

std::string summary(const DirectionErrors& errors) {
  const eval::ErrorStatistics angle = eval::statistics_of(errors.angles_deg);
  const eval::ErrorStatistics squared = eval::statistics_of(errors.squared_by_sigma);
  return fmt::format("median {:.3f} deg, p95 {:.3f} deg; NEES mean {:.2f}, median {:.2f} (n = {})", angle.median,
                     angle.p95, squared.mean, squared.median, angle.count);
}

std::string summary(const Share& share) { return fmt::format("{:.1f} % of {}", share.percent(), share.whole); }

std::vector<std::size_t> indices_of(const std::vector<features::DirectionFeature>& directions,
                                    features::DirectionKind kind) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (directions[i].kind == kind) indices.push_back(i);
  }
  return indices;
}

}  // namespace eg::features_eval
