#include "common/tracking/plane_estimate.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/random_geometry.hpp"

namespace eg::tracking {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector4d;
using geometry::Plane;
using geometry::Pose;

constexpr double kTilt = 0.004;    // radians
constexpr double kHeight = 0.003;  // metres

Vector4d as_vector(const Plane& plane) {
  Vector4d vector;
  vector << plane.normal, plane.distance;
  return vector;
}

/// A plane through `centroid`, known to kTilt about it and kHeight at it.
PlaneEstimate estimate_at(const Plane& plane, const Vector3d& centroid) {
  Eigen::Matrix<double, 4, 3> jacobian = Eigen::Matrix<double, 4, 3>::Zero();
  jacobian.topLeftCorner<3, 2>() = geometry::tangent_basis(plane.normal);
  jacobian.bottomLeftCorner<1, 2>() = -centroid.transpose() * jacobian.topLeftCorner<3, 2>();
  jacobian(3, 2) = 1.0;
  const Vector3d sigmas(kTilt, kTilt, kHeight);
  return {plane, jacobian * sigmas.cwiseAbs2().asDiagonal() * jacobian.transpose()};
}

/// A measurement of the plane with that uncertainty.
Plane disturbed(const Plane& plane, const Vector3d& centroid, base::Random& random) {
  const Vector3d normal = test::disturbed_direction(plane.normal, kTilt, random);
  return {normal, -normal.dot(centroid) + kHeight * random.normal() + plane.signed_distance(centroid)};
}

struct Scene {
  Vector3d centroid;
  Plane plane;
  explicit Scene(base::Random& random) : centroid(test::normal_vector(random, 2.0)) {
    plane.normal = test::random_direction(random);
    plane.distance = -plane.normal.dot(centroid);
  }
};

TEST(PlaneEstimate, TransformedCovarianceMatchesSamples) {
  base::Random random(1);
  for (int scene_number = 0; scene_number < 5; ++scene_number) {
    const Scene scene(random);
    const Pose b_from_a = test::random_pose(random, 2.0);
    const PlaneEstimate in_b = transform(b_from_a, estimate_at(scene.plane, scene.centroid));
    Matrix4d sampled = Matrix4d::Zero();
    constexpr int kSamples = 10'000;
    for (int i = 0; i < kSamples; ++i) {
      const Plane seen = geometry::transform(b_from_a, disturbed(scene.plane, scene.centroid, random));
      const Vector4d error = as_vector(seen) - as_vector(in_b.plane);
      sampled += error * error.transpose() / kSamples;
    }
    EXPECT_LT((sampled - in_b.covariance).norm(), 0.05 * in_b.covariance.norm());
  }
}

TEST(PlaneEstimate, TransformThereAndBackChangesNothing) {
  base::Random random(2);
  const Scene scene(random);
  const PlaneEstimate in_a = estimate_at(scene.plane, scene.centroid);
  const Pose b_from_a = test::random_pose(random, 3.0);
  const PlaneEstimate back = transform(b_from_a.inverse(), transform(b_from_a, in_a));
  EXPECT_TRUE(back.plane.normal.isApprox(in_a.plane.normal, 1e-12));
  EXPECT_NEAR(back.plane.distance, in_a.plane.distance, 1e-12);
  EXPECT_TRUE(back.covariance.isApprox(in_a.covariance, 1e-9));
}

TEST(PlaneEstimate, HeightVarianceMatchesSamplesAndGrowsWithTheLever) {
  base::Random random(3);
  const Scene scene(random);
  const PlaneEstimate estimate = estimate_at(scene.plane, scene.centroid);
  EXPECT_NEAR(height_variance(estimate, scene.centroid), kHeight * kHeight, 1e-12);
  const Vector3d aside = scene.centroid + 2.0 * geometry::tangent_basis(scene.plane.normal).col(0);
  EXPECT_NEAR(height_variance(estimate, aside), kHeight * kHeight + 4.0 * kTilt * kTilt, 1e-12);
  double sampled = 0.0;
  constexpr int kSamples = 10'000;
  for (int i = 0; i < kSamples; ++i) {
    const double height = disturbed(scene.plane, scene.centroid, random).signed_distance(aside);
    sampled += height * height / kSamples;
  }
  EXPECT_NEAR(sampled / height_variance(estimate, aside), 1.0, 0.06);
}

TEST(PlaneEstimate, HeightVarianceIsTheSameInEveryFrame) {
  base::Random random(4);
  const Scene scene(random);
  const PlaneEstimate in_a = estimate_at(scene.plane, scene.centroid);
  const Pose b_from_a = test::random_pose(random, 3.0);
  const Vector3d point = test::normal_vector(random, 2.0);
  const Vector3d on_plane = point - scene.plane.signed_distance(point) * scene.plane.normal;
  EXPECT_NEAR(height_variance(transform(b_from_a, in_a), b_from_a * on_plane) / height_variance(in_a, on_plane), 1.0,
              1e-9);
}

TEST(PlaneEstimate, FusionConvergesAndIsConsistent) {
  // Mean of chi²(3) of the fused plane; the floor on the covariance makes it a little smaller.
  base::Random random(5);
  double sum = 0.0;
  constexpr int kTrials = 500;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Scene scene(random);
    PlaneEstimate fused = estimate_at(disturbed(scene.plane, scene.centroid, random), scene.centroid);
    for (int view = 0; view < 10; ++view) {
      const Vector3d seen_at = scene.centroid + 0.5 * geometry::tangent_basis(scene.plane.normal) *
                                                    Eigen::Vector2d(random.normal(), random.normal());
      fuse(fused, estimate_at(disturbed(scene.plane, seen_at, random), seen_at));
    }
    ASSERT_NEAR(fused.plane.normal.norm(), 1.0, 1e-12);
    ASSERT_LT(geometry::axial_angle(fused.plane.normal, scene.plane.normal), 0.01);
    Eigen::Matrix<double, 4, 3> basis = Eigen::Matrix<double, 4, 3>::Zero();
    basis.topLeftCorner<3, 2>() = geometry::tangent_basis(fused.plane.normal);
    basis(3, 2) = 1.0;
    const Vector3d error = basis.transpose() * (as_vector(scene.plane) - as_vector(fused.plane));
    sum += error.dot((basis.transpose() * fused.covariance * basis).inverse() * error);
  }
  EXPECT_GT(sum / kTrials, 2.0);
  EXPECT_LT(sum / kTrials, 3.4);
}

TEST(PlaneEstimate, FusingExactPlanesIsNoDivisionByZero) {
  PlaneEstimate plane{{Vector3d::UnitZ(), 1.0}, Matrix4d::Zero()};
  fuse(plane, {{Vector3d::UnitZ(), 1.0}, Matrix4d::Zero()});
  EXPECT_TRUE(plane.covariance.allFinite());
  EXPECT_NEAR(plane.plane.distance, 1.0, 1e-12);
}

}  // namespace
}  // namespace eg::tracking
