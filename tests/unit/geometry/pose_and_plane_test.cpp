#include <gtest/gtest.h>

#include "common/geometry/depth_noise.hpp"
#include "common/geometry/plane.hpp"
#include "common/geometry/pose.hpp"
#include "common/geometry/so3.hpp"

namespace eg::geometry {
namespace {

using Eigen::Vector3d;

const Pose kBFromA{so3_exp({0.4, -1.1, 0.3}), {1.0, -2.0, 0.5}};
const Pose kCFromB{so3_exp({-0.9, 0.2, 2.0}), {0.3, 4.0, -1.5}};

TEST(Pose, ComposesAndInverts) {
  const Vector3d p(0.2, -0.7, 3.0);
  EXPECT_NEAR(((kCFromB * kBFromA) * p - kCFromB * (kBFromA * p)).norm(), 0.0, 1e-14);
  EXPECT_NEAR((kBFromA.inverse() * (kBFromA * p) - p).norm(), 0.0, 1e-14);
  const Pose identity = kBFromA * kBFromA.inverse();
  EXPECT_NEAR((identity.rotation - Eigen::Matrix3d::Identity()).norm() + identity.translation.norm(), 0.0, 1e-14);
}

TEST(Plane, KeepsItsDistancesUnderTransformation) {
  const Plane in_a{Vector3d(1, 2, -2) / 3.0, 0.7};
  const Plane in_b = transform(kBFromA, in_a);
  EXPECT_NEAR(in_b.normal.norm(), 1.0, 1e-14);
  for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(1, -3, 2), Vector3d(5, 5, 5)}) {
    EXPECT_NEAR(in_a.signed_distance(p), in_b.signed_distance(kBFromA * p), 1e-13);
  }
}

TEST(Plane, NormalTowardsTheCameraMeansAPositiveDistance) {
  const Plane wall{-Vector3d::UnitZ(), 2.0};  // two metres ahead, facing the camera
  EXPECT_NEAR(wall.signed_distance({0.3, 0.1, 2.0}), 0.0, 1e-15);
  EXPECT_GT(wall.signed_distance(Vector3d::Zero()), 0.0);
}

TEST(DepthSigma, GrowsWithDepth) {
  EXPECT_NEAR(depth_sigma(0.4), 0.0012, 1e-12);
  EXPECT_NEAR(depth_sigma(2.4), 0.0012 + 0.0019 * 4.0, 1e-12);
  for (double z = 0.5; z < 8.0; z += 0.5) EXPECT_GT(depth_sigma(z + 0.5), depth_sigma(z));
}

}  // namespace
}  // namespace eg::geometry
