// estimate_rotation(): consensus over the minimal solver and weighted refinement.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

#include "common/egraph/rotation_solver.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::egraph {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geometry::rotation_angle_between;
using test::disturbed_direction;
using test::kDegree;
using test::random_direction;
using test::random_rotation;
using test::tangential_covariance;

DirectionPair exact_pair(const Matrix3d& j_from_k, const Vector3d& in_k, double sigma) {
  const Vector3d in_j = j_from_k * in_k;
  return {in_j, in_k, tangential_covariance(in_j, sigma), tangential_covariance(in_k, sigma)};
}

/// A pair disturbed in both frames by the noise that its covariances state.
DirectionPair noisy_pair(const Matrix3d& j_from_k, const Vector3d& in_k, double sigma_j, double sigma_k,
                         base::Random& random) {
  const Vector3d in_j = j_from_k * in_k;
  return {disturbed_direction(in_j, sigma_j, random), disturbed_direction(in_k, sigma_k, random),
          tangential_covariance(in_j, sigma_j), tangential_covariance(in_k, sigma_k)};
}

TEST(EstimateRotation, RecoversExactProblems) {
  base::Random random(10);
  int degenerate = 0;
  for (int trial = 0; trial < 3'000; ++trial) {
    const Matrix3d truth = random_rotation(random);
    std::vector<DirectionPair> pairs;
    for (int i = 0; i < 2 + trial % 6; ++i) pairs.push_back(exact_pair(truth, random_direction(random), 0.01));
    const RotationEstimate estimate = estimate_rotation(pairs);
    if (estimate.status == RotationStatus::degenerate) {
      ++degenerate;
      continue;
    }
    ASSERT_EQ(estimate.status, RotationStatus::ok);
    ASSERT_LT(rotation_angle_between(estimate.j_from_k, truth), 1e-9);
    ASSERT_EQ(estimate.inlier_count, static_cast<int>(pairs.size()));
    ASSERT_TRUE(std::all_of(estimate.inliers.begin(), estimate.inliers.end(), [](bool inlier) { return inlier; }));
    ASSERT_GT(estimate.smallest_eigenvalue, 0.0);
  }
  EXPECT_LT(degenerate, 30) << "two random directions are within 10 degrees in 1.5 % of the cases";
}

TEST(EstimateRotation, ManyVaguePairsDoNotOutvoteTwoWalls) {
  // Eight single lines were taken for the neighbours of their landmarks, all half a degree off to the same side.
  const Matrix3d truth = geometry::so3_exp({0.3, -0.2, 0.5});
  const Matrix3d wrong = geometry::so3_exp({0.0, 0.5 * kDegree, 0.0}) * truth;
  std::vector<DirectionPair> pairs = {exact_pair(truth, Vector3d::UnitX(), 0.05 * kDegree),
                                      exact_pair(truth, Vector3d::UnitZ(), 0.05 * kDegree)};
  for (DirectionPair& wall : pairs) wall.outlier_chi2 = 17.0;
  base::Random random(12);
  for (int i = 0; i < 8; ++i) {
    pairs.push_back(exact_pair(wrong, random_direction(random), 0.15 * kDegree));
    pairs.back().outlier_chi2 = 2.0;
  }
  const RotationEstimate estimate = estimate_rotation(pairs);
  ASSERT_EQ(estimate.status, RotationStatus::ok);
  EXPECT_TRUE(estimate.inliers[0] && estimate.inliers[1]);
  EXPECT_LT(rotation_angle_between(estimate.j_from_k, truth), 0.3 * kDegree);

  for (DirectionPair& pair : pairs) pair.outlier_chi2 = 13.82;  // where all count alike, the majority wins
  EXPECT_LT(rotation_angle_between(estimate_rotation(pairs).j_from_k, wrong), 0.1 * kDegree);
}

TEST(EstimateRotation, ChoosesAmongAlternatives) {
  // Each direction may be one of three neighbours; the wrong ones lie first, and to different sides.
  base::Random random(13);
  for (int trial = 0; trial < 200; ++trial) {
    const Matrix3d truth = random_rotation(random);
    std::vector<DirectionPair> pairs;
    for (int observation = 0; observation < 5; ++observation) {
      const DirectionPair right = noisy_pair(truth, random_direction(random), 0.001, 0.001, random);
      for (int alternative = 0; alternative < 3; ++alternative) {
        pairs.push_back(right);
        pairs.back().observation = observation;
        if (alternative < 2) pairs.back().in_k = disturbed_direction(right.in_k, 3.0 * kDegree, random);
      }
    }
    const RotationEstimate estimate = estimate_rotation(pairs);
    ASSERT_EQ(estimate.status, RotationStatus::ok);
    EXPECT_LT(rotation_angle_between(estimate.j_from_k, truth), 0.5 * kDegree);
    for (std::size_t i = 0; i < pairs.size(); i += 3) {
      EXPECT_LE(estimate.inliers[i] + estimate.inliers[i + 1] + estimate.inliers[i + 2], 1);
    }
  }
}

TEST(EstimateRotation, OneObservationIsTooFew) {
  std::vector<DirectionPair> pairs = {exact_pair(Matrix3d::Identity(), Vector3d::UnitX(), 0.01),
                                      exact_pair(Matrix3d::Identity(), Vector3d::UnitY(), 0.01)};
  EXPECT_EQ(estimate_rotation(pairs).status, RotationStatus::ok);
  for (DirectionPair& pair : pairs) pair.observation = 0;
  EXPECT_EQ(estimate_rotation(pairs).status, RotationStatus::too_few);
}

TEST(EstimateRotation, ThePriorDecidesWhatTheDirectionsLeaveOpen) {
  // Three orthogonal walls look the same after a quarter turn when each wall may be any of the landmarks.
  const Matrix3d quarter = geometry::so3_exp({0.0, 0.0, 90.0 * kDegree});
  std::vector<DirectionPair> pairs;
  for (int wall = 0; wall < 3; ++wall) {
    for (int landmark = 0; landmark < 3; ++landmark) {
      for (const double sign : {1.0, -1.0}) {
        pairs.push_back(exact_pair(Matrix3d::Identity(), Matrix3d::Identity().col(landmark), 0.01));
        pairs.back().in_j = sign * Matrix3d::Identity().col(wall);
        pairs.back().observation = wall;
      }
    }
  }
  for (const Matrix3d& truth : {Matrix3d(Matrix3d::Identity()), quarter}) {
    const RotationPrior prior{geometry::so3_exp({0.05, -0.1, 0.1}) * truth, 0.2};
    const RotationEstimate estimate = estimate_rotation(pairs, {}, prior);
    ASSERT_EQ(estimate.status, RotationStatus::ok);
    EXPECT_LT(rotation_angle_between(estimate.j_from_k, truth), 1e-6) << "the prior chooses, but does not pull";
  }
}

TEST(EstimateRotation, ExactDataWithoutCovarianceIsNoDivisionByZero) {
  const Matrix3d truth = geometry::so3_exp({0.3, -0.2, 0.5});
  const std::vector<DirectionPair> pairs = {exact_pair(truth, Vector3d::UnitX(), 0.0),
                                            exact_pair(truth, Vector3d::UnitY(), 0.0)};
  const RotationEstimate estimate = estimate_rotation(pairs);
  ASSERT_EQ(estimate.status, RotationStatus::ok);
  EXPECT_LT(rotation_angle_between(estimate.j_from_k, truth), 1e-9);
  EXPECT_TRUE(estimate.covariance.allFinite());
}

TEST(EstimateRotation, SaysWhenThereAreTooFewPairs) {
  EXPECT_EQ(estimate_rotation({}).status, RotationStatus::too_few);
  const std::vector<DirectionPair> one = {exact_pair(Matrix3d::Identity(), Vector3d::UnitX(), 0.01)};
  const RotationEstimate estimate = estimate_rotation(one);
  EXPECT_EQ(estimate.status, RotationStatus::too_few);
  ASSERT_EQ(estimate.inliers.size(), 1U);
  EXPECT_FALSE(estimate.inliers[0]);
}

TEST(EstimateRotation, SaysWhenAllDirectionsAreParallel) {
  // Errata (c): an edge needs two or more matched landmarks that are not parallel. Many parallel ones do not do.
  base::Random random(11);
  const Matrix3d truth = random_rotation(random);
  std::vector<DirectionPair> pairs;
  for (int i = 0; i < 10; ++i) {
    const Vector3d in_k = (i % 2 == 0 ? 1.0 : -1.0) * disturbed_direction(Vector3d::UnitZ(), 2.0 * kDegree, random);
    pairs.push_back(exact_pair(truth, in_k, 0.01));
  }
  EXPECT_EQ(estimate_rotation(pairs).status, RotationStatus::degenerate);
}

TEST(EstimateRotation, SaysWhenNoTwoPairsAgree) {
  // The angle between the directions is 90 degrees in one frame and 60 in the other.
  const Vector3d tilted(std::cos(60 * kDegree), std::sin(60 * kDegree), 0);
  const std::vector<DirectionPair> pairs = {
      {Vector3d::UnitX(), Vector3d::UnitX(), tangential_covariance(Vector3d::UnitX(), 0.01),
       tangential_covariance(Vector3d::UnitX(), 0.01)},
      {Vector3d::UnitY(), tilted, tangential_covariance(Vector3d::UnitY(), 0.01), tangential_covariance(tilted, 0.01)}};
  const RotationEstimate estimate = estimate_rotation(pairs);
  EXPECT_EQ(estimate.status, RotationStatus::inconsistent);
  EXPECT_EQ(estimate.inlier_count, 0);
}

/// The mistakes that matching makes: another direction, the wrong sign, two matches swapped.
void spoil(std::vector<DirectionPair>& pairs, std::size_t wrong, base::Random& random) {
  for (std::size_t i = 0; i < wrong; ++i) {
    DirectionPair& pair = pairs[i];
    switch (random.index(3)) {
      case 0:
        pair.in_k = random_direction(random);
        break;
      case 1:
        pair.in_k = -pair.in_k;
        break;
      default:
        std::swap(pair.in_k, pairs[(i + 1) % wrong].in_k);
        break;
    }
    pair.covariance_k = tangential_covariance(pair.in_k, 0.01);
  }
}

TEST(EstimateRotation, SurvivesFortyPercentWrongPairs) {
  base::Random random(12);
  int wrong_results = 0;
  constexpr int kTrials = 500;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Matrix3d truth = random_rotation(random);
    const std::size_t count = 10 + static_cast<std::size_t>(random.index(6));
    std::vector<DirectionPair> pairs;
    for (std::size_t i = 0; i < count; ++i) {
      pairs.push_back(noisy_pair(truth, random_direction(random), 0.01, 0.01, random));
    }
    spoil(pairs, count * 4 / 10, random);
    const RotationEstimate estimate = estimate_rotation(pairs);
    ASSERT_EQ(estimate.status, RotationStatus::ok) << "trial " << trial;
    if (rotation_angle_between(estimate.j_from_k, truth) > 2.0 * kDegree) ++wrong_results;
  }
  EXPECT_EQ(wrong_results, 0);
}

TEST(EstimateRotation, MarksTheWrongPairs) {
  base::Random random(13);
  const Matrix3d truth = random_rotation(random);
  std::vector<DirectionPair> pairs;
  for (int i = 0; i < 3; ++i) pairs.push_back(noisy_pair(truth, Vector3d::Unit(i), 0.005, 0.005, random));
  pairs.push_back(noisy_pair(truth, Vector3d(1, 1, 1).normalized(), 0.005, 0.005, random));
  pairs.push_back(exact_pair(truth, Vector3d(1, -1, 1).normalized(), 0.005));
  pairs.back().in_k *= -1.0;
  const RotationEstimate estimate = estimate_rotation(pairs);
  ASSERT_EQ(estimate.status, RotationStatus::ok);
  EXPECT_EQ(estimate.inliers, (std::vector<bool>{true, true, true, true, false}));
  EXPECT_EQ(estimate.inlier_count, 4);
}

TEST(EstimateRotation, ACertainPairCountsMoreThanAnUncertainOne) {
  base::Random random(14);
  const Matrix3d truth = random_rotation(random);
  std::vector<DirectionPair> pairs = {exact_pair(truth, Vector3d::UnitX(), 0.001),
                                      exact_pair(truth, Vector3d::UnitY(), 0.001),
                                      exact_pair(truth, Vector3d::UnitZ(), 0.02)};
  pairs[2].in_k = geometry::so3_exp({0.02, 0.02, 0.0}) * pairs[2].in_k;
  const RotationEstimate estimate = estimate_rotation(pairs);
  ASSERT_EQ(estimate.status, RotationStatus::ok);
  EXPECT_EQ(estimate.inlier_count, 3);
  EXPECT_LT(rotation_angle_between(estimate.j_from_k, truth), 0.001);
}

/// Mean of the normalised estimation error squared over many noisy problems; 3 if the covariance is right.
double mean_nees(int directions, double sigma_j, double sigma_k, bool elongated, base::Random& random) {
  double sum = 0.0;
  constexpr int kTrials = 1'500;
  // All pairs stay inliers: the covariance is that of the plain estimator, not of a truncated one.
  const RotationOptions options{.inlier_chi2 = 60.0, .max_inlier_angle = 0.5};
  for (int trial = 0; trial < kTrials; ++trial) {
    const Matrix3d truth = random_rotation(random);
    std::vector<DirectionPair> pairs;
    for (int i = 0; i < directions; ++i) {
      const Vector3d in_k = random_rotation(random) * Vector3d::Unit(i % 3);
      pairs.push_back(noisy_pair(truth, i < 2 ? Vector3d(Vector3d::Unit(i)) : in_k, sigma_j, sigma_k, random));
      if (!elongated) continue;
      // Uncertain about one axis only, as a vanishing direction across the image plane is.
      DirectionPair& pair = pairs.back();
      const Vector3d exact_in_j = truth * (i < 2 ? Vector3d(Vector3d::Unit(i)) : in_k);
      const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(exact_in_j);
      const Eigen::Vector2d sigmas(sigma_j, 4.0 * sigma_j);
      const Eigen::Vector2d noise(sigmas[0] * random.normal(), sigmas[1] * random.normal());
      pair.in_j = (exact_in_j + basis * noise).normalized();
      pair.covariance_j = basis * sigmas.cwiseAbs2().asDiagonal() * basis.transpose();
    }
    const RotationEstimate estimate = estimate_rotation(pairs, options);
    EXPECT_EQ(estimate.status, RotationStatus::ok);
    const Vector3d error = geometry::so3_log(estimate.j_from_k * truth.transpose());
    sum += error.dot(estimate.covariance.inverse() * error);
  }
  return sum / kTrials;
}

TEST(EstimateRotation, CovarianceIsConsistent) {
  // The mean of 1500 samples of chi²(3) has a standard deviation of sqrt(6 / 1500) = 0.063.
  base::Random random(15);
  EXPECT_NEAR(mean_nees(2, 0.005, 0.005, false, random), 3.0, 0.25);
  EXPECT_NEAR(mean_nees(3, 0.01, 0.002, false, random), 3.0, 0.25);
  EXPECT_NEAR(mean_nees(8, 0.01, 0.01, false, random), 3.0, 0.25);
  EXPECT_NEAR(mean_nees(5, 0.005, 0.005, true, random), 3.0, 0.25);
}

TEST(EstimateRotation, SmallestEigenvalueTellsHowWellItIsObserved) {
  // Rotation about the common axis of two near directions is observed by sin² of their angle only.
  const double angle = 20.0 * kDegree;
  const std::vector<DirectionPair> pairs = {
      exact_pair(Matrix3d::Identity(), Vector3d::UnitZ(), 0.01),
      exact_pair(Matrix3d::Identity(), Vector3d(std::sin(angle), 0, std::cos(angle)), 0.01)};
  const RotationEstimate estimate = estimate_rotation(pairs);
  ASSERT_EQ(estimate.status, RotationStatus::ok);
  // Each direction has variance 2 * 0.01² across it (both frames), and sees nothing about itself: about the axis
  // halfway between the two, each contributes sin²(angle / 2).
  const double expected = 2.0 * std::pow(std::sin(angle / 2), 2) / (2e-4 + 3e-8);
  EXPECT_NEAR(estimate.smallest_eigenvalue / expected, 1.0, 1e-6);
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(estimate.covariance);
  EXPECT_NEAR(eigen.eigenvalues()[2] * estimate.smallest_eigenvalue, 1.0, 1e-9);
}

TEST(EstimateRotation, DoesNotDependOnTheOrderOfPairsBeyondRounding) {
  base::Random random(16);
  for (int trial = 0; trial < 50; ++trial) {
    const Matrix3d truth = random_rotation(random);
    std::vector<DirectionPair> pairs;
    for (int i = 0; i < 12; ++i) pairs.push_back(noisy_pair(truth, random_direction(random), 0.01, 0.02, random));
    spoil(pairs, 3, random);
    const RotationEstimate first = estimate_rotation(pairs);
    std::reverse(pairs.begin(), pairs.end());
    const RotationEstimate second = estimate_rotation(pairs);
    ASSERT_EQ(first.inlier_count, second.inlier_count);
    EXPECT_LT(rotation_angle_between(first.j_from_k, second.j_from_k), 1e-6);
  }
}

TEST(EstimateRotation, ManyPairsAreQuick) {
  base::Random random(17);
  const Matrix3d truth = random_rotation(random);
  std::vector<DirectionPair> pairs;
  for (int i = 0; i < 500; ++i) pairs.push_back(noisy_pair(truth, random_direction(random), 0.01, 0.01, random));
  const RotationEstimate estimate = estimate_rotation(pairs);
  ASSERT_EQ(estimate.status, RotationStatus::ok);
  EXPECT_LT(rotation_angle_between(estimate.j_from_k, truth), 0.3 * kDegree);
}

}  // namespace
}  // namespace eg::egraph
