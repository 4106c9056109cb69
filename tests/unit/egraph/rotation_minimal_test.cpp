// The closed-form solvers of the paper's section 3.1, with the errata of docs/algorithm.md.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

#include "common/egraph/rotation_solver.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::egraph {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::kDegree;
using test::random_direction;
using test::random_rotation;

template <std::size_t N>
std::array<Vector3d, N> rotated(const Matrix3d& j_from_k, const std::array<Vector3d, N>& in_k) {
  std::array<Vector3d, N> in_j;
  for (std::size_t i = 0; i < N; ++i) in_j[i] = j_from_k * in_k[i];
  return in_j;
}

double sine_between(const Vector3d& a, const Vector3d& b) { return a.normalized().cross(b.normalized()).norm(); }

bool is_rotation(const Matrix3d& matrix) {
  return (matrix.transpose() * matrix).isIdentity(1e-9) && matrix.determinant() > 0.0;
}

TEST(RotationFromTwo, IsExactWhereverTheDirectionsAreNotParallel) {
  base::Random random(1);
  int solved = 0;
  for (int trial = 0; trial < 100'000; ++trial) {
    const Matrix3d truth = random_rotation(random);
    const std::array<Vector3d, 2> in_k = {random_direction(random), random_direction(random)};
    const auto rotation = rotation_from_two(rotated(truth, in_k), in_k);
    const double sine = sine_between(in_k[0], in_k[1]);
    if (std::abs(sine - std::sin(kMinAngleBetweenDirections)) < 1e-9) continue;
    ASSERT_EQ(rotation.has_value(), sine > std::sin(kMinAngleBetweenDirections)) << "trial " << trial;
    if (!rotation) continue;
    ASSERT_TRUE(rotation->isApprox(truth, 1e-12)) << "trial " << trial;
    ++solved;
  }
  EXPECT_GT(solved, 95'000);
}

TEST(RotationFromThree, IsExactWhereverTheDirectionsAreIndependent) {
  base::Random random(2);
  int solved = 0;
  for (int trial = 0; trial < 100'000; ++trial) {
    const Matrix3d truth = random_rotation(random);
    const std::array<Vector3d, 3> in_k = {random_direction(random), random_direction(random), random_direction(random)};
    const auto rotation = rotation_from_three(rotated(truth, in_k), in_k);
    if (!rotation) continue;
    ASSERT_TRUE(rotation->isApprox(truth, 1e-11)) << "trial " << trial;
    ++solved;
  }
  EXPECT_GT(solved, 75'000);
}

TEST(RotationFromOrthogonal, IsExactForTriads) {
  base::Random random(3);
  for (int trial = 0; trial < 10'000; ++trial) {
    const Matrix3d truth = random_rotation(random);
    const Matrix3d triad = random_rotation(random) * (trial % 2 == 0 ? 1.0 : -1.0);  // left-handed triads are as good
    const std::array<Vector3d, 3> in_k = {triad.col(0), triad.col(1), triad.col(2)};
    const auto rotation = rotation_from_orthogonal(rotated(truth, in_k), in_k);
    ASSERT_TRUE(rotation.has_value());
    ASSERT_TRUE(rotation->isApprox(truth, 1e-12));
  }
}

TEST(RotationFromOrthogonal, SpreadsNoiseOverAllThreeDirections) {
  // Equation 6 as it stands is no rotation when directions are noisy; the nearest rotation to it is, and has no
  // preferred direction, unlike Gram-Schmidt.
  base::Random random(4);
  Vector3d squared = Vector3d::Zero();
  for (int trial = 0; trial < 4'000; ++trial) {
    const Matrix3d truth = random_rotation(random);
    std::array<Vector3d, 3> in_k = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
    const auto in_j = rotated(truth, in_k);
    for (Vector3d& direction : in_k) direction = test::disturbed_direction(direction, 0.02, random);
    const auto rotation = rotation_from_orthogonal(in_j, in_k);
    ASSERT_TRUE(rotation.has_value());
    ASSERT_TRUE(is_rotation(*rotation));
    squared += geometry::so3_log(truth.transpose() * *rotation).cwiseAbs2();
  }
  EXPECT_LT(squared.maxCoeff() / squared.minCoeff(), 1.15);
}

// Errata (a): proj divides by <u, u>, and (b): u2 subtracts the projections on u0 and u1.
TEST(OrthonormalBasis, IsOrthonormalForObliqueDirections) {
  base::Random random(5);
  for (int trial = 0; trial < 10'000; ++trial) {
    // Of any length: a projection that divides by <u, v> returns u itself, and one on v1 leaves a part of u1.
    const Vector3d v0 = random.uniform(0.2, 5.0) * random_direction(random);
    const Vector3d v1 = random.uniform(0.2, 5.0) * random_direction(random);
    const Vector3d v2 = random.uniform(0.2, 5.0) * random_direction(random);
    if (const auto two = orthonormal_basis(v0, v1)) {
      ASSERT_TRUE(is_rotation(*two));
      ASSERT_NEAR(two->col(0).dot(v0.normalized()), 1.0, 1e-12);
      ASSERT_NEAR(two->col(2).dot(v1.normalized()), 0.0, 1e-12);
    }
    if (const auto three = orthonormal_basis(v0, v1, v2)) {
      ASSERT_TRUE((three->transpose() * *three).isIdentity(1e-9));
      ASSERT_GT(three->col(1).dot(v1), 0.0);
      ASSERT_GT(three->col(2).dot(v2), 0.0);
    }
  }
}

TEST(OrthonormalBasis, OfAKnownObliqueTriple) {
  const Vector3d v0(1, 0, 0);
  const Vector3d v1(1, 1, 0);
  const Vector3d v2(1, 1, 1);
  const auto basis = orthonormal_basis(v0, v1, v2);
  ASSERT_TRUE(basis.has_value());
  EXPECT_TRUE(basis->isIdentity(1e-12)) << *basis;
}

// Errata (d): both bases may be left-handed; their quotient is a rotation all the same.
TEST(RotationFromThree, LeftHandedTriplesGiveRotations) {
  base::Random random(6);
  const std::array<Vector3d, 3> in_k = {Vector3d(0, 1, 0), Vector3d(1, 0.2, 0), Vector3d(0.1, 0.3, 1)};
  ASSERT_LT(orthonormal_basis(in_k[0], in_k[1], in_k[2])->determinant(), 0.0);
  const Matrix3d truth = random_rotation(random);
  const auto rotation = rotation_from_three(rotated(truth, in_k), in_k);
  ASSERT_TRUE(rotation.has_value());
  EXPECT_TRUE(rotation->isApprox(truth, 1e-12));
}

// Errata (d): if noise flips one of two nearly coplanar triples, the quotient is a reflection, which is refused.
TEST(RotationFromThree, RefusesTriplesOfOppositeHandedness) {
  const double lift = std::sin(12.0 * kDegree);  // just beyond what counts as coplanar
  const Vector3d above = Vector3d(1, 1, lift * std::sqrt(2.0)).normalized();
  const Vector3d below = Vector3d(1, 1, -lift * std::sqrt(2.0)).normalized();
  const std::array<Vector3d, 3> in_j = {Vector3d::UnitX(), Vector3d::UnitY(), above};
  const std::array<Vector3d, 3> in_k = {Vector3d::UnitX(), Vector3d::UnitY(), below};
  EXPECT_TRUE(rotation_from_three(in_j, in_j).has_value());
  EXPECT_FALSE(rotation_from_three(in_j, in_k).has_value());
}

TEST(RotationFromOrthogonal, RefusesTriadsOfOppositeHandedness) {
  const std::array<Vector3d, 3> right = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
  const std::array<Vector3d, 3> left = {Vector3d::UnitX(), Vector3d::UnitY(), -Vector3d::UnitZ()};
  EXPECT_FALSE(rotation_from_orthogonal(right, left).has_value());
  EXPECT_FALSE(rotation_from_orthogonal(left, right).has_value());
  EXPECT_TRUE(rotation_from_orthogonal(left, left).has_value());
}

TEST(MinimalSolvers, RefuseDegenerateDirections) {
  const Vector3d x = Vector3d::UnitX();
  const Vector3d y = Vector3d::UnitY();
  const Vector3d near_x = Vector3d(1, std::tan(9.0 * kDegree), 0).normalized();
  EXPECT_FALSE(orthonormal_basis(x, x).has_value());
  EXPECT_FALSE(orthonormal_basis(x, -x).has_value());
  EXPECT_FALSE(orthonormal_basis(x, near_x).has_value());
  EXPECT_FALSE(orthonormal_basis(x, near_x, Vector3d::UnitZ()).has_value());
  EXPECT_FALSE(orthonormal_basis(x, y, Vector3d(1, 1, 0)).has_value()) << "coplanar";
  EXPECT_FALSE(orthonormal_basis(x, y, Vector3d(1, -1, 0.1)).has_value()) << "near coplanar";
  EXPECT_FALSE(rotation_from_two({x, y}, {x, near_x}).has_value()) << "parallel in one frame only";
  EXPECT_FALSE(rotation_from_two({x, near_x}, {x, y}).has_value());
  EXPECT_FALSE(rotation_from_orthogonal({x, y, x}, {x, y, x}).has_value());
}

TEST(MinimalSolvers, RefuseWhatIsNoDirection) {
  const Vector3d zero = Vector3d::Zero();
  const Vector3d nan = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  const Vector3d x = Vector3d::UnitX();
  const Vector3d y = Vector3d::UnitY();
  EXPECT_FALSE(orthonormal_basis(zero, x).has_value());
  EXPECT_FALSE(orthonormal_basis(x, zero).has_value());
  EXPECT_FALSE(orthonormal_basis(x, nan).has_value());
  EXPECT_FALSE(orthonormal_basis(nan, x, y).has_value());
  EXPECT_FALSE(orthonormal_basis(x, y, nan).has_value());
}

}  // namespace
}  // namespace eg::egraph
