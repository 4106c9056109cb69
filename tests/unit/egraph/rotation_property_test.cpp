// A hundred thousand random problems with noise and with the mistakes that association makes: opposite signs,
// directions that were exchanged, and directions that have nothing to do with each other.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

#include "common/egraph/rotation_solver.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::egraph {
namespace {

using Eigen::Vector3d;
using test::kDegree;

constexpr double kSigma = 0.2 * kDegree;
constexpr int kProblems = 100'000;

/// Directions of which no two are closer than 25 degrees, signs aside.
std::vector<Vector3d> scene(int count, base::Random& random) {
  std::vector<Vector3d> directions;
  while (static_cast<int>(directions.size()) < count) {
    const Vector3d candidate = test::random_direction(random);
    const auto close = [&](const Vector3d& other) { return geometry::axial_angle(candidate, other) < 25.0 * kDegree; };
    if (std::none_of(directions.begin(), directions.end(), close)) directions.push_back(candidate);
  }
  return directions;
}

struct Problem {
  Eigen::Matrix3d truth;
  std::vector<DirectionPair> pairs;
  std::size_t wrong = 0;  ///< the last ones
};

Problem random_problem(base::Random& random) {
  Problem problem{test::random_rotation(random), {}, static_cast<std::size_t>(random.index(4))};
  const std::vector<Vector3d> directions = scene(4 + random.index(2), random);
  for (const Vector3d& in_k : directions) {
    const Vector3d in_j = test::disturbed_direction(problem.truth * in_k, kSigma, random);
    problem.pairs.push_back({in_j, test::disturbed_direction(in_k, kSigma, random),
                             test::tangential_covariance(in_j, kSigma), test::tangential_covariance(in_k, kSigma)});
  }
  // As many again may be wrong, but for one: the right ones stay the majority.
  for (std::size_t i = 0; i < problem.wrong; ++i) {
    DirectionPair mistake = problem.pairs[i];
    const int kind = random.index(3);
    if (kind == 0) mistake.in_j = -mistake.in_j;
    if (kind == 1) mistake.in_j = problem.pairs[i + 1].in_j;
    if (kind == 2) mistake.in_j = test::random_direction(random);
    mistake.covariance_j = test::tangential_covariance(mistake.in_j, kSigma);
    problem.pairs.push_back(mistake);
  }
  return problem;
}

TEST(EstimateRotation, AHundredThousandRandomProblemsWithMistakes) {
  base::Random random(77);
  int wrong_rotations = 0;
  int wrong_inliers = 0;
  int outside_covariance = 0;
  for (int i = 0; i < kProblems; ++i) {
    const Problem problem = random_problem(random);
    const RotationEstimate estimate = estimate_rotation(problem.pairs);
    ASSERT_EQ(estimate.status, RotationStatus::ok) << "problem " << i;
    ASSERT_NEAR(estimate.j_from_k.determinant(), 1.0, 1e-9);
    const Vector3d error = geometry::so3_log(problem.truth * estimate.j_from_k.transpose());
    if (error.norm() > 2.0 * kDegree) ++wrong_rotations;
    if (error.dot(estimate.covariance.ldlt().solve(error)) > 16.27) ++outside_covariance;  // 99.9 % of chi²(3)
    for (std::size_t last = 0; last < problem.wrong; ++last) {
      const std::size_t pair = problem.pairs.size() - 1 - last;
      if (estimate.inliers[pair] && error.norm() < 2.0 * kDegree) ++wrong_inliers;
    }
  }
  // Two mistakes now and then agree with each other and with a right pair as well as the right ones do.
  EXPECT_LT(wrong_rotations, kProblems / 1000);
  EXPECT_LT(outside_covariance, kProblems / 100);
  EXPECT_LT(wrong_inliers, kProblems / 100) << "a random direction is right by chance in 1 of 250";
}

}  // namespace
}  // namespace eg::egraph
