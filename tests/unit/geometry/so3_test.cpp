#include "common/geometry/so3.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "common/base/random.hpp"

namespace eg::geometry {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d random_vector(base::Random& random, double size) {
  const Vector3d v(random.normal(), random.normal(), random.normal());
  return size * v.normalized();
}

TEST(So3, HatIsTheCrossProduct) {
  base::Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Vector3d a = random_vector(random, 2.0);
    const Vector3d b = random_vector(random, 3.0);
    EXPECT_NEAR((hat(a) * b - a.cross(b)).norm(), 0.0, 1e-14);
  }
}

TEST(So3, ExpAgreesWithAxisAndAngle) {
  base::Random random(2);
  for (int i = 0; i < 100; ++i) {
    const double angle = random.uniform(1e-3, 6.0);
    const Vector3d axis = random_vector(random, 1.0);
    const Matrix3d expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    EXPECT_NEAR((so3_exp(angle * axis) - expected).norm(), 0.0, 1e-12);
  }
}

TEST(So3, LogIsTheInverseOfExpFromTinyAnglesUpToPi) {
  base::Random random(3);
  for (const double angle : {0.0, 1e-15, 1e-10, 1e-8, 9.9e-7, 1.1e-6, 1e-3, 0.5, 2.0, 3.1, std::numbers::pi - 1e-6}) {
    const Vector3d w = random_vector(random, angle);
    EXPECT_NEAR((so3_log(so3_exp(w)) - w).norm(), 0.0, 1e-9 * std::max(angle, 1e-6)) << angle;
  }
}

TEST(So3, LogAtPiIsOneOfTheTwoAnswers) {
  base::Random random(4);
  for (int i = 0; i < 20; ++i) {
    const Vector3d w = random_vector(random, std::numbers::pi);
    const Vector3d log = so3_log(so3_exp(w));
    EXPECT_NEAR(log.norm(), std::numbers::pi, 1e-7);
    EXPECT_NEAR(axial_angle(log, w), 0.0, 1e-7);
  }
}

TEST(So3, SmallRotationsAreAccurateToFirstOrder) {
  const Vector3d w(1e-9, -2e-9, 3e-9);
  EXPECT_NEAR((so3_exp(w) - Matrix3d::Identity() - hat(w)).norm(), 0.0, 1e-16);
  EXPECT_NEAR((so3_log(Matrix3d::Identity() + hat(w)) - w).norm(), 0.0, 1e-16);
}

TEST(So3, AngleBetweenRotations) {
  const Matrix3d a = so3_exp({0.3, -0.2, 0.9});
  EXPECT_NEAR(rotation_angle_between(a, a), 0.0, 1e-9);
  EXPECT_NEAR(rotation_angle_between(a, a * so3_exp({0, 0.7, 0})), 0.7, 1e-12);
  EXPECT_NEAR(rotation_angle_between(a, so3_exp({0, 0.7, 0}) * a), 0.7, 1e-12);
}

TEST(So3, NearestRotationIsARotationAndKeepsRotations) {
  base::Random random(5);
  for (int i = 0; i < 50; ++i) {
    const Matrix3d rotation = so3_exp(random_vector(random, random.uniform(0.0, 3.0)));
    EXPECT_NEAR((nearest_rotation(rotation) - rotation).norm(), 0.0, 1e-12);
    EXPECT_NEAR((nearest_rotation(2.5 * rotation) - rotation).norm(), 0.0, 1e-12);
    Matrix3d noisy = rotation;
    for (int k = 0; k < 9; ++k) noisy(k) += 0.3 * random.normal();
    const Matrix3d nearest = nearest_rotation(noisy);
    EXPECT_NEAR((nearest.transpose() * nearest - Matrix3d::Identity()).norm(), 0.0, 1e-12);
    EXPECT_NEAR(nearest.determinant(), 1.0, 1e-12);
    // No rotation beside it is nearer.
    for (int k = 0; k < 6; ++k) {
      const Matrix3d other = nearest * so3_exp(random_vector(random, 0.01));
      EXPECT_LE((nearest - noisy).norm(), (other - noisy).norm());
    }
  }
}

TEST(So3, NearestRotationOfAReflectionIsStillARotation) {
  const Matrix3d mirror = Vector3d(1, 1, -0.5).asDiagonal();
  EXPECT_NEAR(nearest_rotation(mirror).determinant(), 1.0, 1e-12);
}

TEST(So3, TangentBasisCompletesADirection) {
  base::Random random(6);
  for (int i = 0; i < 50; ++i) {
    const Vector3d direction = i < 3 ? Vector3d(Vector3d::Unit(i)) : random_vector(random, 1.0);
    Matrix3d basis;
    basis << tangent_basis(direction), direction;
    EXPECT_NEAR((basis.transpose() * basis - Matrix3d::Identity()).norm(), 0.0, 1e-12);
    EXPECT_NEAR(basis.determinant(), 1.0, 1e-12);
  }
}

TEST(So3, AxialAngleIgnoresSignsAndIsAccurateWhenSmall) {
  const Vector3d x = Vector3d::UnitX();
  EXPECT_NEAR(axial_angle(x, -x), 0.0, 1e-15);
  EXPECT_NEAR(axial_angle(x, Vector3d::UnitY()), std::numbers::pi / 2, 1e-15);
  EXPECT_NEAR(axial_angle(x, {std::cos(2.5), std::sin(2.5), 0}), std::numbers::pi - 2.5, 1e-12);
  EXPECT_NEAR(axial_angle(x, {1.0, 1e-9, 0}), 1e-9, 1e-18) << "an arc cosine would lose it";
}

}  // namespace
}  // namespace eg::geometry
