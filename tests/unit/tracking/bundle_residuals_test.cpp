// Every analytic Jacobian of bundle_residuals.hpp against differences, by the pose and by the landmark.
#include "common/tracking/bundle_residuals.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "common/geometry/so3.hpp"
#include "common/tracking/segment_error.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::tracking {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;
using geometry::Plane;
using geometry::Pose;

constexpr double kStep = 1e-6;

/// Central differences of a function of a step in R^M at zero.
template <int N, int M>
Eigen::Matrix<double, N, M> differences(
    const std::function<Eigen::Matrix<double, N, 1>(const Eigen::Matrix<double, M, 1>&)>& residual) {
  Eigen::Matrix<double, N, M> jacobian;
  for (int i = 0; i < M; ++i) {
    const Eigen::Matrix<double, M, 1> step = kStep * Eigen::Matrix<double, M, 1>::Unit(i);
    jacobian.col(i) = (residual(step) - residual(-step)) / (2.0 * kStep);
  }
  return jacobian;
}

template <typename A, typename B>
void expect_near_relative(const A& analytic, const B& numeric) {
  EXPECT_LT((analytic - numeric).norm(), 1e-6 * (1.0 + numeric.norm())) << analytic << "\nbut by differences\n"
                                                                        << numeric;
}

/// A positive fy, and a negative one as ICL-NUIM has it.
class BundleResiduals : public testing::TestWithParam<const char*> {
 protected:
  Vector3d visible_point(const Pose& camera_from_world) {
    const Vector2d pixel(random_.uniform(0, camera_.width), random_.uniform(0, camera_.height));
    return camera_from_world.inverse() * camera_.unproject(pixel, random_.uniform(0.5, 5.0));
  }

  base::Random random_{3};
  geometry::CameraModel camera_ = *geometry::find_camera(GetParam());
};

TEST_P(BundleResiduals, OfAPoint) {
  for (int trial = 0; trial < 100; ++trial) {
    const Pose pose = test::random_pose(random_, 2.0);
    PointFactor factor;
    factor.point_in_world = visible_point(pose);
    factor.pixel = camera_.project(pose * factor.point_in_world) + Vector2d(2, -3);
    factor.depth = trial % 3 == 0 ? 0.0 : (pose * factor.point_in_world).z() + 0.1;
    factor.depth_sigma = 0.05;
    const auto at = bundle_point_residual(factor, camera_, pose);
    EXPECT_NEAR(at.value.z(), trial % 3 == 0 ? 0.0 : -2.0, 1e-9);
    const auto by_pose = [&](const Vector6d& d) {
      return bundle_point_residual(factor, camera_, perturb(pose, d)).value;
    };
    const auto by_point = [&](const Vector3d& d) {
      PointFactor moved = factor;
      moved.point_in_world += d;
      return bundle_point_residual(moved, camera_, pose).value;
    };
    expect_near_relative(at.by_pose, differences<3, 6>(by_pose));
    expect_near_relative(at.by_landmark, differences<3, 3>(by_point));
  }
}

TEST_P(BundleResiduals, OfALine) {
  for (int trial = 0; trial < 100; ++trial) {
    const Pose pose = test::random_pose(random_, 2.0);
    const LineChart chart(visible_point(pose), visible_point(pose));
    const Vector4d offsets(0.02, -0.01, 0.03, 0.01);
    LineObservation seen;
    const double angle = random_.uniform(0, 6.28);
    seen.image_line = Vector3d(std::cos(angle), std::sin(angle), random_.uniform(-300, 300));
    seen.image_whitener = whitener(test::random_covariance(random_, 0.5, 3.0));
    seen.has_depth = trial % 3 != 0;
    seen.point_in_camera = pose * visible_point(pose);
    seen.inwards = test::random_direction(random_);
    seen.inwards_whitener = whitener(test::random_covariance(random_, 0.01, 0.1));
    const auto at = bundle_line_residual(seen, chart, offsets, camera_, pose);
    const auto by_pose = [&](const Vector6d& d) {
      return bundle_line_residual(seen, chart, offsets, camera_, perturb(pose, d)).value;
    };
    const auto by_offsets = [&](const Vector4d& d) {
      return bundle_line_residual(seen, chart, offsets + d, camera_, pose).value;
    };
    expect_near_relative(at.by_pose, differences<4, 6>(by_pose));
    expect_near_relative(at.by_landmark, differences<4, 4>(by_offsets));
  }
}

TEST_P(BundleResiduals, OfAPlane) {
  for (int trial = 0; trial < 100; ++trial) {
    const Pose pose = test::random_pose(random_, 2.0);
    const Plane plane{test::random_direction(random_), random_.uniform(-3, 3)};
    PlaneObservation seen;
    seen.normal_in_camera = test::disturbed_direction(pose.rotation * plane.normal, 0.05, random_);
    seen.normal_covariance = 1e-4 * Eigen::Matrix3d::Identity();
    seen.centroid_in_camera = pose * visible_point(pose);
    seen.height_sigma = random_.uniform(0.002, 0.05);
    const auto at = bundle_plane_residual(seen, plane, pose);
    const auto by_pose = [&](const Vector6d& d) { return bundle_plane_residual(seen, plane, perturb(pose, d)).value; };
    const auto by_plane = [&](const Vector3d& d) {
      return bundle_plane_residual(seen, move_plane(plane, d), pose).value;
    };
    expect_near_relative(at.by_pose, differences<3, 6>(by_pose));
    expect_near_relative(at.by_landmark, differences<3, 3>(by_plane));
  }
}

TEST_P(BundleResiduals, VanishWhereTheMeasurementIsExact) {
  const Pose pose = test::random_pose(random_, 2.0);
  const Vector3d a = visible_point(pose);
  const Vector3d b = visible_point(pose);
  const Vector3d crossing = camera_.project(pose * a).homogeneous().cross(camera_.project(pose * b).homogeneous());
  LineObservation line;
  line.image_line = crossing / crossing.head<2>().norm();
  line.has_depth = true;
  line.point_in_camera = pose * (0.3 * a + 0.7 * b);  // any point of the line will do
  const Vector3d along = (pose * b - pose * a).normalized();
  line.inwards = along.cross((pose * a).cross(along).normalized());
  EXPECT_LT(bundle_line_residual(line, LineChart(a, b), Vector4d::Zero(), camera_, pose).value.norm(), 1e-9);

  const Plane plane{test::random_direction(random_), 1.3};
  PlaneObservation wall;
  wall.normal_in_camera = pose.rotation * plane.normal;
  wall.centroid_in_camera = pose * Vector3d(a - plane.signed_distance(a) * plane.normal);
  EXPECT_LT(bundle_plane_residual(wall, plane, pose).value.norm(), 1e-9);
}

TEST(PlaneCoordinates, DifferenceInvertsTheMove) {
  base::Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const Plane plane{test::random_direction(random), random.uniform(-3, 3)};
    const Vector3d step(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-1, 1));
    EXPECT_LT((plane_difference(plane, move_plane(plane, step)) - step).norm(), 1e-12);
  }
}

TEST(PoseCoordinates, DifferenceInvertsThePerturbation) {
  base::Random random(6);
  for (int trial = 0; trial < 200; ++trial) {
    const Pose pose = test::random_pose(random, 3.0);
    Vector6d step;
    step << test::normal_vector(random, 0.3), test::normal_vector(random, 0.5);
    EXPECT_LT((pose_difference(pose, perturb(pose, step)) - step).norm(), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, BundleResiduals, testing::Values("tum_fr3", "icl"),
                         [](const auto& camera) { return std::string(camera.param); });

}  // namespace
}  // namespace eg::tracking
