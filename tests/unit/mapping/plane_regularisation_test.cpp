#include "common/mapping/plane_regularisation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "common/base/random.hpp"
#include "tests/support/plane_scenes.hpp"

namespace eg::mapping {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A plane as an extractor would give it that found it exactly, in the pixels of a rectangle.
DepthPlane exact_plane(const geometry::CameraModel& camera, const geometry::Plane& plane, const cv::Rect& pixels) {
  DepthPlane depth_plane{plane, Eigen::Matrix4d::Zero(), static_cast<double>(pixels.area()), {}};
  const double left = pixels.x, top = pixels.y, right = pixels.x + pixels.width - 1,
               bottom = pixels.y + pixels.height - 1;
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(left, top), Eigen::Vector2d(right, top),
                                        Eigen::Vector2d(right, bottom), Eigen::Vector2d(left, bottom)}) {
    const Eigen::Vector3d ray = camera.ray(corner);
    depth_plane.hull.emplace_back(-plane.distance / plane.normal.dot(ray) * ray);
  }
  return depth_plane;
}

bool is_same(const cv::Mat& a, const cv::Mat& b) {
  for (int v = 0; v < a.rows; ++v) {
    if (std::memcmp(a.ptr(v), b.ptr(v), a.cols * sizeof(float)) != 0) return false;
  }
  return true;
}

/// Share of the pixels of `part` that differ.
double changed_share(const cv::Mat& a, const cv::Mat& b, const cv::Rect& part) {
  return static_cast<double>(cv::countNonZero(a(part) != b(part))) / part.area();
}

double rms_error(const cv::Mat& depth, const cv::Mat& truth, const cv::Rect& part) {
  return cv::norm(depth(part), truth(part), cv::NORM_L2) / std::sqrt(part.area());
}

double mean(const cv::Mat& depth, const cv::Rect& part) { return cv::mean(depth(part))[0]; }

/// A wall at `distance`, seen with the sensor's noise.
struct NoisyWall {
  explicit NoisyWall(double distance, double slant = 0.0)
      : scene{test::vga_camera(), {test::plane_through({0, 0, distance}, {slant, 0.3 * slant, -1.0})}},
        truth(scene.depth()),
        all(0, 0, truth.cols, truth.rows),
        plane(exact_plane(scene.camera, scene.planes[0], all)) {}

  [[nodiscard]] cv::Mat seen() const {
    cv::Mat depth = truth.clone();
    base::Random random(5);
    test::add_white_noise(depth, random);
    return depth;
  }
  [[nodiscard]] cv::Mat regularise(const cv::Mat& depth) const {
    return regularise_depth(depth, scene.camera, {plane});
  }

  test::PlaneScene scene;
  cv::Mat truth;
  cv::Rect all;
  DepthPlane plane;
};

TEST(PlaneRegularisationTest, ReadingsOnAnExactPlaneLoseTheirNoise) {
  for (const double slant : {0.0, 0.7}) {
    const NoisyWall wall(2.0, slant);
    const cv::Mat depth = wall.seen();
    const cv::Mat regularised = wall.regularise(depth);
    // What is left are the 0.3 % of the readings that are more than three standard deviations off.
    EXPECT_LT(rms_error(regularised, wall.truth, wall.all), 0.25 * rms_error(depth, wall.truth, wall.all)) << slant;
    EXPECT_GT(changed_share(regularised, depth, wall.all), 0.98) << slant;
  }
}

TEST(PlaneRegularisationTest, APlaneAsUncertainAsAReadingCountsAsMuch) {
  NoisyWall wall(2.0);
  wall.plane.covariance(3, 3) = std::pow(geometry::depth_sigma(2.0), 2);
  const cv::Mat depth = wall.seen();
  const cv::Mat regularised = wall.regularise(depth);
  const double ratio = rms_error(regularised, wall.truth, wall.all) / rms_error(depth, wall.truth, wall.all);
  EXPECT_NEAR(ratio, 0.5, 0.03);
}

TEST(PlaneRegularisationTest, AnUncertainPlaneChangesNextToNothing) {
  NoisyWall wall(2.0);
  wall.plane.covariance(3, 3) = 1.0;  // metres squared
  const cv::Mat depth = wall.seen();
  EXPECT_LT(cv::norm(wall.regularise(depth), depth, cv::NORM_INF), 1e-4 * wall.truth.at<float>(0, 0));
}

TEST(PlaneRegularisationTest, AnObjectOnTheWallStays) {
  const NoisyWall wall(2.0);
  const cv::Rect object(203, 101, 45, 38);  // not along the cells
  cv::Mat depth = wall.seen();
  depth(object) -= 3.0 * geometry::depth_sigma(2.0);
  const cv::Mat regularised = wall.regularise(depth);
  EXPECT_LT(changed_share(regularised, depth, object), 0.03);
  EXPECT_GT(changed_share(regularised, depth, {0, 0, 200, 480}), 0.98) << "beside it";
}

TEST(PlaneRegularisationTest, AThinRodBeforeTheWallStays) {
  const NoisyWall wall(2.0);
  const cv::Rect rod(300, 0, 3, 480);
  cv::Mat depth = wall.seen();
  depth(rod) -= 0.05;
  const cv::Mat regularised = wall.regularise(depth);
  EXPECT_TRUE(is_same(regularised(rod), depth(rod)));
}

/// Two surfaces side by side, found as one plane: that of the left one.
TEST(PlaneRegularisationTest, AStepOfSomeMillimetresIsNotSmeared) {
  struct Step {
    double distance, height;  // metres
  };
  for (const Step& step : {Step{0.8, 0.004}, Step{1.5, 0.006}, Step{2.0, 0.010}, Step{2.7, 0.020}}) {
    const NoisyWall wall(step.distance);
    const cv::Rect right(350, 0, 290, 480), beside_step(350, 0, 16, 480);
    cv::Mat depth = wall.seen();
    depth(right) += step.height;
    const cv::Mat regularised = wall.regularise(depth);
    EXPECT_NEAR(mean(regularised, right), mean(depth, right), 0.01 * step.height) << step.distance;
    // A quarter of the cells on the step, two columns, may look like the left surface.
    EXPECT_NEAR(mean(regularised, beside_step), mean(depth, beside_step), 0.14 * step.height) << step.distance;
    EXPECT_GT(changed_share(regularised, depth, {0, 0, 330, 480}), 0.95) << step.distance;
  }
}

TEST(PlaneRegularisationTest, WithoutNoiseEvenAMillimetreStays) {
  const NoisyWall wall(2.0);
  cv::Mat depth = wall.truth.clone();
  base::Random random(3);
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) depth.at<float>(v, u) += static_cast<float>(1e-4 * (random.uniform() - 0.5));
  }
  const cv::Rect plate(203, 101, 45, 38);
  depth(plate) -= 0.001;
  const cv::Mat regularised = wall.regularise(depth);
  EXPECT_LT(changed_share(regularised, depth, plate), 0.1);
  EXPECT_LT(rms_error(regularised, wall.truth, {0, 0, 200, 480}), 1e-5);
}

TEST(PlaneRegularisationTest, BesideACreaseEitherSideKeepsItsPlane) {
  test::PlaneScene scene{
      test::vga_camera(),
      {test::plane_through({0, 0, 2.0}, {0.6, 0, -1}), test::plane_through({0, 0, 2.0}, {-0.6, 0, -1})}};
  const cv::Mat truth = scene.depth();
  cv::Mat depth = truth.clone();
  base::Random random(5);
  test::add_white_noise(depth, random);
  const cv::Rect left(0, 0, 320, 480), right(320, 0, 320, 480), beside(304, 0, 32, 480);
  const int plane_of_left = scene.hit(100, 240).first;
  const cv::Mat regularised = regularise_depth(depth, scene.camera,
                                               {exact_plane(scene.camera, scene.planes[plane_of_left], left),
                                                exact_plane(scene.camera, scene.planes[1 - plane_of_left], right)});
  for (const cv::Rect& part : {left, right, beside}) {
    EXPECT_LT(rms_error(regularised, truth, part), 0.3 * rms_error(depth, truth, part));
  }
}

TEST(PlaneRegularisationTest, WhatIsNoReadingStaysNone) {
  const NoisyWall wall(2.0);
  cv::Mat depth = wall.seen();
  const float infinite = std::numeric_limits<float>::infinity();
  int column = 0;
  for (const float none : {0.0F, -1.0F, static_cast<float>(kNaN), infinite, -infinite}) {
    depth.col(100 + 3 * column++).setTo(none);
  }
  const cv::Mat regularised = wall.regularise(depth);
  for (int i = 0; i < column; ++i) EXPECT_TRUE(is_same(regularised.col(100 + 3 * i), depth.col(100 + 3 * i))) << i;
  EXPECT_GT(changed_share(regularised, depth, {101, 0, 2, 480}), 0.98) << "readings between them are regularised";
  const cv::Mat empty = cv::Mat::zeros(depth.size(), CV_32FC1);
  EXPECT_TRUE(is_same(wall.regularise(empty), empty));
}

TEST(PlaneRegularisationTest, PlanesThatCannotBeAreLeftOut) {
  const NoisyWall wall(2.0);
  const cv::Mat depth = wall.seen();
  std::vector<DepthPlane> wrong(10, wall.plane);
  wrong[0].plane.normal.x() = kNaN;
  wrong[1].plane.distance = kNaN;
  wrong[2].plane.distance = -wrong[2].plane.distance;  // behind the camera
  wrong[3].plane.normal *= 2.0;
  wrong[4].covariance(0, 0) = std::numeric_limits<double>::infinity();
  wrong[5].hull[1].y() = kNaN;
  for (Eigen::Vector3d& corner : wrong[6].hull) corner = -corner;
  wrong[7].hull[2].z() = 0.0;
  wrong[8].hull.resize(2);
  wrong[9].support = 0.0;
  EXPECT_TRUE(is_same(regularise_depth(depth, wall.scene.camera, wrong), depth));
}

TEST(PlaneRegularisationTest, AHullMayReachOutOfTheImageOrLieOutsideIt) {
  NoisyWall wall(2.0);
  const cv::Mat depth = wall.seen();
  const auto shifted = [&](double x, double y) {
    DepthPlane plane = wall.plane;
    for (Eigen::Vector3d& corner : plane.hull) corner += Eigen::Vector3d(x, y, 0.0);
    return regularise_depth(depth, wall.scene.camera, {plane});
  };
  for (const auto& [x, y] : {std::pair{9.0, 0.0}, {-9.0, 0.0}, {0.0, 9.0}, {0.0, -9.0}, {1e30, 1e30}}) {
    EXPECT_TRUE(is_same(shifted(x, y), depth)) << x << " " << y;
  }
  const cv::Mat right_half = shifted(1.22, 0.0);  // 320 pixels at 2 m
  EXPECT_TRUE(is_same(right_half(cv::Rect(0, 0, 312, 480)), depth(cv::Rect(0, 0, 312, 480))));
  EXPECT_GT(changed_share(right_half, depth, {328, 0, 312, 480}), 0.98);
}

}  // namespace
}  // namespace eg::mapping
