#include "common/egraph/rotation_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/geometry/so3.hpp"

namespace eg::egraph {
namespace {

using geometry::tangent_basis;

const double kMinSine = std::sin(kMinAngleBetweenDirections);

/// Floor on the standard deviation of a pair (0.01°): keeps exact data from dividing by zero.
constexpr double kMinVariance = 3e-8;

Eigen::Vector3d projection(const Eigen::Vector3d& u, const Eigen::Vector3d& v) { return u.dot(v) / u.dot(u) * u; }

/// The tangential residual of a pair at a rotation, its information and its Jacobian for R ← exp(δ) R.
struct PairResidual {
  Eigen::Vector2d residual;
  Eigen::Matrix2d information;
  Eigen::Matrix<double, 2, 3> jacobian;

  PairResidual(const DirectionPair& pair, const Eigen::Matrix3d& j_from_k) {
    const Eigen::Matrix<double, 3, 2> basis = tangent_basis(pair.in_j);
    const Eigen::Vector3d predicted = j_from_k * pair.in_k;
    const Eigen::Matrix3d covariance = pair.covariance_j + j_from_k * pair.covariance_k * j_from_k.transpose();
    residual = basis.transpose() * predicted;
    information = (basis.transpose() * covariance * basis + kMinVariance * Eigen::Matrix2d::Identity()).inverse();
    jacobian = -basis.transpose() * geometry::hat(predicted);
  }

  [[nodiscard]] double chi2() const { return residual.dot(information * residual); }
};

bool agrees(const DirectionPair& pair, const Eigen::Matrix3d& j_from_k, const RotationOptions& options, double& chi2) {
  const Eigen::Vector3d predicted = j_from_k * pair.in_k;
  if (predicted.dot(pair.in_j) < std::cos(options.max_inlier_angle)) return false;
  chi2 = PairResidual(pair, j_from_k).chi2();
  return chi2 < options.inlier_chi2;
}

double total_variance(const DirectionPair& pair) { return pair.covariance_j.trace() + pair.covariance_k.trace(); }

bool alternatives(const DirectionPair& a, const DirectionPair& b) {
  return a.observation >= 0 && a.observation == b.observation;
}

/// One observation's alternatives: pairs [begin, end).
struct Observation {
  std::size_t begin = 0;
  std::size_t end = 0;
  double outlier_chi2 = 0.0;
};

std::vector<Observation> group(std::span<const DirectionPair> pairs) {
  std::vector<Observation> observations;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i == 0 || !alternatives(pairs[i], pairs[i - 1])) observations.push_back({i, i, 0.0});
    observations.back().end = i + 1;
    observations.back().outlier_chi2 = std::max(observations.back().outlier_chi2, pairs[i].outlier_chi2);
  }
  return observations;
}

/// The alternative that fits best among those that agree; pairs.size() if none does.
std::size_t best_alternative(const Observation& observation, std::span<const DirectionPair> pairs,
                             const Eigen::Matrix3d& j_from_k, const RotationOptions& options, double& best_chi2) {
  std::size_t best = pairs.size();
  best_chi2 = options.inlier_chi2;
  for (std::size_t i = observation.begin; i < observation.end; ++i) {
    double chi2 = 0.0;
    if (!agrees(pairs[i], j_from_k, options, chi2) || chi2 >= best_chi2) continue;
    best_chi2 = chi2;
    best = i;
  }
  return best;
}

/// -2 ln of the likelihood of a rotation up to a constant; infinite if fewer than two observations agree with it, or if
/// it reaches `enough` on the way.
double cost_of(const Eigen::Matrix3d& j_from_k, std::span<const Observation> observations,
               std::span<const DirectionPair> pairs, const RotationOptions& options, const RotationPrior& prior,
               double enough) {
  double cost = std::pow(geometry::rotation_angle_between(j_from_k, prior.j_from_k) / prior.sigma, 2.0);
  int agreeing = 0;
  for (const Observation& observation : observations) {
    double chi2 = 0.0;
    const bool agrees = best_alternative(observation, pairs, j_from_k, options, chi2) < pairs.size();
    cost += agrees ? std::min(chi2, observation.outlier_chi2) : observation.outlier_chi2;
    agreeing += agrees ? 1 : 0;
    if (cost >= enough) break;
  }
  return agreeing < 2 || cost >= enough ? std::numeric_limits<double>::infinity() : cost;
}

/// The most likely of the rotations of all couples of pairs that at least two pairs agree with.
std::optional<Eigen::Matrix3d> best_hypothesis(std::span<const DirectionPair> pairs,
                                               std::span<const Observation> observations,
                                               const RotationOptions& options, const RotationPrior& prior) {
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return total_variance(pairs[a]) < total_variance(pairs[b]); });
  const std::size_t count = std::min(order.size(), static_cast<std::size_t>(options.max_hypothesis_pairs));

  std::optional<Eigen::Matrix3d> best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) {
      const DirectionPair& first = pairs[order[a]];
      const DirectionPair& second = pairs[order[b]];
      if (alternatives(first, second)) continue;
      const auto rotation = rotation_from_two({first.in_j, second.in_j}, {first.in_k, second.in_k});
      if (!rotation) continue;
      const double cost = cost_of(*rotation, observations, pairs, options, prior, best_cost);
      if (cost >= best_cost) continue;
      best_cost = cost;
      best = rotation;
    }
  }
  return best;
}

bool any_two_span_a_plane(std::span<const DirectionPair> pairs) {
  for (std::size_t a = 0; a < pairs.size(); ++a) {
    for (std::size_t b = a + 1; b < pairs.size(); ++b) {
      if (pairs[a].in_k.cross(pairs[b].in_k).norm() > kMinSine) return true;
    }
  }
  return false;
}

}  // namespace

std::optional<Eigen::Matrix3d> orthonormal_basis(const Eigen::Vector3d& v0, const Eigen::Vector3d& v1) {
  const Eigen::Vector3d u0 = v0.normalized();
  const Eigen::Vector3d u1 = v1.normalized() - projection(u0, v1.normalized());
  if (!(u1.norm() > kMinSine)) return std::nullopt;
  Eigen::Matrix3d basis;
  basis << u0, u1.normalized(), u0.cross(u1.normalized());
  return basis;
}

std::optional<Eigen::Matrix3d> orthonormal_basis(const Eigen::Vector3d& v0, const Eigen::Vector3d& v1,
                                                 const Eigen::Vector3d& v2) {
  const Eigen::Vector3d u0 = v0.normalized();
  const Eigen::Vector3d u1 = v1.normalized() - projection(u0, v1.normalized());
  if (!(u1.norm() > kMinSine)) return std::nullopt;
  const Eigen::Vector3d u2 = v2.normalized() - projection(u0, v2.normalized()) - projection(u1, v2.normalized());
  if (!(u2.norm() > kMinSine)) return std::nullopt;
  Eigen::Matrix3d basis;
  basis << u0, u1.normalized(), u2.normalized();
  return basis;
}

std::optional<Eigen::Matrix3d> rotation_from_two(const std::array<Eigen::Vector3d, 2>& in_j,
                                                 const std::array<Eigen::Vector3d, 2>& in_k) {
  const auto basis_j = orthonormal_basis(in_j[0], in_j[1]);
  const auto basis_k = orthonormal_basis(in_k[0], in_k[1]);
  if (!basis_j || !basis_k) return std::nullopt;
  return *basis_j * basis_k->transpose();
}

std::optional<Eigen::Matrix3d> rotation_from_three(const std::array<Eigen::Vector3d, 3>& in_j,
                                                   const std::array<Eigen::Vector3d, 3>& in_k) {
  const auto basis_j = orthonormal_basis(in_j[0], in_j[1], in_j[2]);
  const auto basis_k = orthonormal_basis(in_k[0], in_k[1], in_k[2]);
  if (!basis_j || !basis_k) return std::nullopt;
  const Eigen::Matrix3d rotation = *basis_j * basis_k->transpose();
  if (rotation.determinant() < 0.0) return std::nullopt;
  return rotation;
}

std::optional<Eigen::Matrix3d> rotation_from_orthogonal(const std::array<Eigen::Vector3d, 3>& in_j,
                                                        const std::array<Eigen::Vector3d, 3>& in_k) {
  Eigen::Matrix3d triad_j;
  Eigen::Matrix3d triad_k;
  for (int i = 0; i < 3; ++i) {
    triad_j.col(i) = in_j[static_cast<std::size_t>(i)].normalized();
    triad_k.col(i) = in_k[static_cast<std::size_t>(i)].normalized();
  }
  if (triad_j.determinant() * triad_k.determinant() <= 0.0) return std::nullopt;
  return geometry::nearest_rotation(triad_j * triad_k.transpose());
}

RotationEstimate estimate_rotation(std::span<const DirectionPair> pairs, const RotationOptions& options,
                                   const RotationPrior& prior) {
  RotationEstimate estimate;
  estimate.inliers.assign(pairs.size(), false);
  const std::vector<Observation> observations = group(pairs);
  if (observations.size() < 2) return estimate;
  const auto hypothesis = best_hypothesis(pairs, observations, options, prior);
  if (!hypothesis) {
    estimate.status = any_two_span_a_plane(pairs) ? RotationStatus::inconsistent : RotationStatus::degenerate;
    return estimate;
  }

  Eigen::Matrix3d rotation = *hypothesis;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (int iteration = 0; iteration < options.refinement_iterations; ++iteration) {
    information.setZero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    estimate.inlier_count = 0;
    estimate.inliers.assign(pairs.size(), false);
    for (const Observation& observation : observations) {
      double chi2 = 0.0;
      const std::size_t best = best_alternative(observation, pairs, rotation, options, chi2);
      if (best == pairs.size()) continue;
      estimate.inliers[best] = true;
      const PairResidual at(pairs[best], rotation);
      information += at.jacobian.transpose() * at.information * at.jacobian;
      gradient += at.jacobian.transpose() * at.information * at.residual;
      ++estimate.inlier_count;
    }
    const Eigen::Vector3d step = -information.ldlt().solve(gradient);
    if (!step.allFinite()) break;
    rotation = geometry::so3_exp(step) * rotation;
    if (step.norm() < 1e-10) break;
  }

  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
  estimate.smallest_eigenvalue = eigen.eigenvalues()[0];
  if (estimate.inlier_count < 2 || estimate.smallest_eigenvalue <= 0.0) {
    estimate.status = RotationStatus::degenerate;
    return estimate;
  }
  estimate.status = RotationStatus::ok;
  estimate.j_from_k = geometry::nearest_rotation(rotation);
  estimate.covariance = information.inverse();
  return estimate;
}

}  // namespace eg::egraph
