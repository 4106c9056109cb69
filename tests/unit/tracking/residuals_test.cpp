// Every analytic Jacobian of pose_optimizer.hpp against differences.
#include <gtest/gtest.h>

#include <functional>

#include "common/tracking/pose_optimizer.hpp"
#include "common/tracking/segment_error.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::tracking {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Pose;
using test::normal_vector;
using test::random_direction;

/// Central differences of a residual with respect to δ of T ← exp(δ) T.
template <int N>
Eigen::Matrix<double, N, 6> numeric_jacobian(const std::function<Eigen::Matrix<double, N, 1>(const Pose&)>& residual,
                                             const Pose& pose) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix<double, N, 6> jacobian;
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = kStep * Vector6d::Unit(i);
    jacobian.col(i) = (residual(perturb(pose, step)) - residual(perturb(pose, -step))) / (2.0 * kStep);
  }
  return jacobian;
}

template <typename A, typename B>
void expect_near_relative(const A& analytic, const B& numeric) {
  EXPECT_LT((analytic - numeric).norm(), 1e-6 * (1.0 + numeric.norm())) << analytic << "\nbut by differences\n"
                                                                        << numeric;
}

/// A positive fy, and a negative one as ICL-NUIM has it.
class Residuals : public testing::TestWithParam<const char*> {
 protected:
  /// A point in front of the camera, in the world.
  Vector3d visible_point(const Pose& camera_from_world) {
    const Vector2d pixel(random_.uniform(0, camera_.width), random_.uniform(0, camera_.height));
    return camera_from_world.inverse() * camera_.unproject(pixel, random_.uniform(0.5, 5.0));
  }

  base::Random random_{1};
  geometry::CameraModel camera_ = *geometry::find_camera(GetParam());
};

TEST_P(Residuals, OfAPoint) {
  for (int trial = 0; trial < 200; ++trial) {
    const Pose pose = test::random_pose(random_, 2.0);
    const Vector3d point = visible_point(pose);
    const PointFactor factor{point, camera_.project(pose * point) + Vector2d(3, -2), random_.uniform(0.5, 3.0),
                             (pose * point).z() + 0.1, random_.uniform(0.01, 0.2)};
    const PointResidual at = point_residual(factor, camera_, pose);
    ASSERT_TRUE(at.in_front);
    EXPECT_NEAR(at.pixel.x() * factor.pixel_sigma, -3.0, 1e-9);
    EXPECT_NEAR(at.pixel.y() * factor.pixel_sigma, 2.0, 1e-9);
    EXPECT_NEAR(at.depth * factor.depth_sigma, -0.1, 1e-9);
    const std::function<Vector2d(const Pose&)> pixel = [&](const Pose& p) {
      return point_residual(factor, camera_, p).pixel;
    };
    const std::function<Eigen::Matrix<double, 1, 1>(const Pose&)> depth = [&](const Pose& p) {
      return Eigen::Matrix<double, 1, 1>(point_residual(factor, camera_, p).depth);
    };
    expect_near_relative(at.pixel_jacobian, numeric_jacobian<2>(pixel, pose));
    expect_near_relative(at.depth_jacobian, numeric_jacobian<1>(depth, pose));
  }
}

TEST_P(Residuals, OfALine) {
  for (int trial = 0; trial < 200; ++trial) {
    const Pose pose = test::random_pose(random_, 2.0);
    const Eigen::Matrix2d covariance = test::random_covariance(random_, 0.5, 3.0);
    LineFactor factor{visible_point(pose), visible_point(pose), Vector3d::Zero(), whitener(covariance)};
    const double angle = random_.uniform(0, 6.28);
    factor.image_line = Vector3d(std::cos(angle), std::sin(angle), random_.uniform(-300, 300));
    const LineResidual at = line_residual(factor, camera_, pose);
    ASSERT_TRUE(at.in_front);
    const Vector2d start = camera_.project(pose * factor.start_in_world);
    const Vector2d end = camera_.project(pose * factor.end_in_world);
    const Vector2d pixels(factor.image_line.dot(start.homogeneous()), factor.image_line.dot(end.homogeneous()));
    EXPECT_NEAR(at.distances.squaredNorm(), pixels.dot(covariance.inverse() * pixels),
                1e-9 * at.distances.squaredNorm());
    const std::function<Vector2d(const Pose&)> distances = [&](const Pose& p) {
      return line_residual(factor, camera_, p).distances;
    };
    expect_near_relative(at.jacobian, numeric_jacobian<2>(distances, pose));
  }
}

TEST_P(Residuals, OfAPlane) {
  for (int trial = 0; trial < 200; ++trial) {
    const Pose pose = test::random_pose(random_, 2.0);
    const PlaneFactor factor{{random_direction(random_), random_.uniform(-3, 3)}, normal_vector(random_), 0.02};
    const PlaneResidual at = plane_residual(factor, pose);
    // The same height, measured in the world.
    const double height = factor.plane_in_world.signed_distance(pose.inverse() * factor.centroid_in_camera);
    EXPECT_NEAR(at.height * factor.sigma, height, 1e-9);
    const std::function<Eigen::Matrix<double, 1, 1>(const Pose&)> residual = [&](const Pose& p) {
      return Eigen::Matrix<double, 1, 1>(plane_residual(factor, p).height);
    };
    expect_near_relative(at.jacobian, numeric_jacobian<1>(residual, pose));
  }
}

TEST_P(Residuals, OfADirection) {
  for (int trial = 0; trial < 200; ++trial) {
    const Pose pose = test::random_pose(random_, 2.0);
    DirectionFactor factor;
    factor.direction_in_world = random_direction(random_);
    factor.direction_in_camera = test::disturbed_direction(pose.rotation * factor.direction_in_world, 0.05, random_);
    const Vector3d sigmas(0.01, 0.03, 0.02);
    const Eigen::Matrix3d tangent =
        Eigen::Matrix3d::Identity() - factor.direction_in_camera * factor.direction_in_camera.transpose();
    factor.covariance = tangent * sigmas.cwiseAbs2().asDiagonal() * tangent;
    const DirectionResidual at = direction_residual(factor, pose);
    const std::function<Vector2d(const Pose&)> residual = [&](const Pose& p) {
      return direction_residual(factor, p).angle;
    };
    expect_near_relative(at.jacobian, numeric_jacobian<2>(residual, pose));
  }
}

TEST_P(Residuals, BehindTheCameraAreNotInFront) {
  const Pose pose;
  EXPECT_FALSE(point_residual({{0, 0, -1}, {0, 0}}, camera_, pose).in_front);
  EXPECT_FALSE(point_residual({{0, 0, 0}, {0, 0}}, camera_, pose).in_front);
  EXPECT_FALSE(line_residual({{0, 0, 1}, {0, 0, -1}, {1, 0, 0}}, camera_, pose).in_front);
}

TEST_P(Residuals, VanishAtTheTruth) {
  const Pose pose = test::random_pose(random_);
  const Vector3d point = visible_point(pose);
  EXPECT_LT(
      point_residual({point, camera_.project(pose * point), 1.0, (pose * point).z(), 1.0}, camera_, pose).pixel.norm(),
      1e-9);
  const Vector3d direction = random_direction(random_);
  EXPECT_LT(direction_residual({direction, pose.rotation * direction, Eigen::Matrix3d::Zero()}, pose).angle.norm(),
            1e-9);
}

TEST(DirectionResidual, IsWhitened) {
  // Normal noise of the stated covariance makes a residual of unit covariance.
  base::Random random(2);
  const Vector3d direction = random_direction(random);
  const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(direction);
  const Eigen::Matrix2d root{{0.01, 0.0}, {0.02, 0.005}};
  Eigen::Matrix2d sampled = Eigen::Matrix2d::Zero();
  constexpr int kSamples = 10'000;
  for (int i = 0; i < kSamples; ++i) {
    const Vector2d noise = root * Vector2d(random.normal(), random.normal());
    const DirectionFactor factor{direction, (direction + basis * noise).normalized(),
                                 basis * root * root.transpose() * basis.transpose()};
    const Vector2d angle = direction_residual(factor, Pose{}).angle;
    sampled += angle * angle.transpose() / kSamples;
  }
  EXPECT_LT((sampled - Eigen::Matrix2d::Identity()).norm(), 0.06) << sampled;
}

TEST(Perturb, IsALeftPerturbation) {
  base::Random random(3);
  const Pose pose = test::random_pose(random);
  Vector6d delta;
  delta << 0.1, -0.2, 0.3, 1, 2, 3;
  const Vector3d point(0.3, -0.4, 2.0);
  const Vector3d expected = geometry::so3_exp(delta.head<3>()) * (pose * point) + delta.tail<3>();
  EXPECT_LT((perturb(pose, delta) * point - expected).norm(), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Cameras, Residuals, testing::Values("tum_fr3", "icl"),
                         [](const auto& camera) { return std::string(camera.param); });

}  // namespace
}  // namespace eg::tracking
