#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

/// Relative rotation from matched scene directions (paper, section 3.1). Directions are unit vectors; j and k are two
/// camera frames (or a camera and the world). Every function returns R_jk, which takes directions of k to j.
///
/// The paper's three minimal cases are here. Only the two-observation case makes hypotheses in estimate_rotation(): it
/// is the smallest sample, so it needs the fewest true pairs, and a third direction would add its noise to the
/// hypothesis but nothing that the refinement over all inliers does not know. The other two are for whoever has matched
/// triples.
namespace eg::egraph {

/// One scene direction seen from both frames, signs already unified.
struct DirectionPair {
  Eigen::Vector3d in_j = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d in_k = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d covariance_j = Eigen::Matrix3d::Zero();  ///< rad², tangential
  Eigen::Matrix3d covariance_k = Eigen::Matrix3d::Zero();  ///< rad², tangential
  /// What the pair costs at most when it disagrees: -2 ln of the likelihood ratio of a wrong pair to an exact one
  /// (MLESAC; Torr and Zisserman, 2000). Zero: the pair says nothing.
  double outlier_chi2 = 13.82;
  /// Pairs of the same observation stand one behind the other and are alternatives: one of them at most is true.
  std::int32_t observation = -1;  ///< -1: the pair is an observation of its own
};

/// Two directions closer to parallel than this carry too little of the rotation about themselves: at 10 degrees the
/// noise of that component is already amplified by 1 / sin(10°), about six times.
inline constexpr double kMinAngleBetweenDirections = 10.0 * 3.14159265358979323846 / 180.0;

/// The orthonormal basis (columns e0, e1, e0 x e1) of two directions by Gram-Schmidt: the two-observation case.
/// Nothing if they are parallel within kMinAngleBetweenDirections.
std::optional<Eigen::Matrix3d> orthonormal_basis(const Eigen::Vector3d& v0, const Eigen::Vector3d& v1);

/// The orthonormal basis of three directions by Gram-Schmidt, equation 4 with its errata mended: proj divides by <u,
/// u>, and u2 subtracts its projections on u0 and u1. May be left-handed. Nothing if the three lie near one plane.
std::optional<Eigen::Matrix3d> orthonormal_basis(const Eigen::Vector3d& v0, const Eigen::Vector3d& v1,
                                                 const Eigen::Vector3d& v2);

/// Two-observation case. Nothing if the directions are near parallel in either frame.
std::optional<Eigen::Matrix3d> rotation_from_two(const std::array<Eigen::Vector3d, 2>& in_j,
                                                 const std::array<Eigen::Vector3d, 2>& in_k);

/// Three-observation case (below equation 5). Nothing if the directions are near coplanar, or if noise gave the two
/// bases opposite handedness (the result would be a reflection).
std::optional<Eigen::Matrix3d> rotation_from_three(const std::array<Eigen::Vector3d, 3>& in_j,
                                                   const std::array<Eigen::Vector3d, 3>& in_k);

/// Orthogonal-observation case, equation 6: the nearest rotation to V_j V_kᵀ for three mutually orthogonal directions.
/// Nothing if the handedness of the two triads differs.
std::optional<Eigen::Matrix3d> rotation_from_orthogonal(const std::array<Eigen::Vector3d, 3>& in_j,
                                                        const std::array<Eigen::Vector3d, 3>& in_k);

enum class RotationStatus {
  ok,            ///< all three degrees of freedom are observed
  too_few,       ///< fewer than two pairs
  degenerate,    ///< all directions are near parallel
  inconsistent,  ///< no two pairs agree with each other
};

struct RotationOptions {
  double inlier_chi2 = 13.82;      ///< of a pair's two tangential residuals: the 99.9 % quantile of chi²(2)
  double max_inlier_angle = 0.09;  ///< radians (5°): no covariance excuses more than this
  int max_hypothesis_pairs = 40;   ///< the most certain pairs build hypotheses, all of them vote
  int refinement_iterations = 8;
};

struct RotationEstimate {
  RotationStatus status = RotationStatus::too_few;
  Eigen::Matrix3d j_from_k = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< rad², of a left perturbation: R = exp(δ) j_from_k
  double smallest_eigenvalue = 0.0;                      ///< of the information matrix, rad⁻²
  std::vector<bool> inliers;                             ///< one per pair, at most one per observation
  int inlier_count = 0;
};

/// What is known of the rotation beforehand: helps to choose among the hypotheses, and is no part of the estimate.
struct RotationPrior {
  Eigen::Matrix3d j_from_k = Eigen::Matrix3d::Identity();
  double sigma = std::numeric_limits<double>::infinity();  ///< radians, of each turn
};

/// Consensus of the minimal solver over all couples of pairs by the likelihood of all pairs, then weighted least
/// squares on SO(3) over the inliers (Wahba's problem with a full covariance per direction, Gauss-Newton).
/// Deterministic.
RotationEstimate estimate_rotation(std::span<const DirectionPair> pairs, const RotationOptions& options = {},
                                   const RotationPrior& prior = {});

}  // namespace eg::egraph
