#include "common/tracking/observability.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace eg::tracking {
namespace {

/// Added to the block that is marginalised out, so that what is unobserved there counts as unknown, not as singular.
constexpr double kWeak = 1e-6;

/// Eigenvalues ascend: the first is the worst.
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> marginal(const Eigen::Matrix3d& kept, const Eigen::Matrix3d& cross,
                                                        const Eigen::Matrix3d& other) {
  const Eigen::Matrix3d open = other + kWeak * Eigen::Matrix3d::Identity();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(kept - cross * open.ldlt().solve(cross.transpose()));
}

double sigma_of(double information) {
  return information > kWeak ? 1.0 / std::sqrt(information) : std::numeric_limits<double>::infinity();
}

}  // namespace

Observability observability(const Matrix6d& information) {
  const Eigen::Matrix3d rotation = information.topLeftCorner<3, 3>();
  const Eigen::Matrix3d translation = information.bottomRightCorner<3, 3>();
  const Eigen::Matrix3d cross = information.topRightCorner<3, 3>();
  const auto turns = marginal(rotation, cross, translation);
  const auto shifts = marginal(translation, cross.transpose(), rotation);
  return {sigma_of(turns.eigenvalues()[0]), sigma_of(turns.eigenvalues()[1]), turns.eigenvectors().col(0),
          sigma_of(shifts.eigenvalues()[0])};
}

}  // namespace eg::tracking
