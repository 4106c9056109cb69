#include "common/features/plane_extraction.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "common/features/plane_hull.hpp"
#include "tests/support/plane_scenes.hpp"

namespace eg::features {
namespace {

using test::plane_through;
using test::PlaneScene;
using test::vga_camera;

double angle_degrees(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / M_PI;
}

/// A corner of a room: left wall, back wall and floor.
PlaneScene corner(double fy) {
  const double down = fy > 0 ? 1.0 : -1.0;
  return {vga_camera(fy),
          {plane_through({-0.8, 0, 2}, {1, 0, -0.25}), plane_through({0, 0, 3}, {-0.25, 0, -1}),
           plane_through({0, down * 0.9, 2}, {0, -down, -0.1})}};
}

class EitherCamera : public testing::TestWithParam<double> {};

TEST_P(EitherCamera, FindsTheThreePlanesOfACornerExactly) {
  const PlaneScene scene = corner(GetParam());
  const PlaneExtraction result = extract_planes(scene.depth(), scene.camera);
  ASSERT_EQ(result.planes.size(), 3U);
  for (const geometry::Plane& truth : scene.planes) {
    double best = 180;
    for (const PlaneFeature& found : result.planes) {
      const double angle = angle_degrees(found.plane.normal, truth.normal);
      if (angle < best) {
        best = angle;
        EXPECT_GT(found.plane.distance, 0);
        if (angle < 1) {
          EXPECT_NEAR(found.plane.distance, truth.distance, 1e-4);
        }
      }
    }
    EXPECT_LT(best, 0.005);
  }
}

INSTANTIATE_TEST_SUITE_P(SignOfFy, EitherCamera, testing::Values(525.0, -525.0));

TEST(PlaneExtraction, SurvivesImagesWithoutPlanes) {
  const geometry::CameraModel camera = vga_camera();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(extract_planes(cv::Mat(0, 0, CV_32FC1), camera).planes.empty());
  EXPECT_TRUE(extract_planes(cv::Mat(1, 1, CV_32FC1, cv::Scalar(1.0)), camera).planes.empty());
  EXPECT_TRUE(extract_planes(cv::Mat(480, 1, CV_32FC1, cv::Scalar(1.0)), camera).planes.empty());
  for (const double value : {0.0, -1.0, nan, infinity}) {
    const PlaneExtraction result = extract_planes(cv::Mat(480, 640, CV_32FC1, cv::Scalar(value)), camera);
    EXPECT_TRUE(result.planes.empty()) << value;
    EXPECT_EQ(cv::countNonZero(result.labels), 0) << value;
  }
}

TEST(PlaneExtraction, RandomDepthHasNoPlanes) {
  base::Random random(1);
  cv::Mat depth(480, 640, CV_32FC1);
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) depth.at<float>(v, u) = static_cast<float>(random.uniform(0.5, 5.0));
  }
  EXPECT_TRUE(extract_planes(depth, vga_camera()).planes.empty());
}

TEST(PlaneExtraction, CheckerboardOfTwoDepthsHasAtMostThoseTwoPlanes) {
  for (const int side : {3, 40}) {
    cv::Mat depth(480, 640, CV_32FC1);
    for (int v = 0; v < depth.rows; ++v) {
      for (int u = 0; u < depth.cols; ++u) depth.at<float>(v, u) = (u / side + v / side) % 2 == 0 ? 1.5F : 2.5F;
    }
    const PlaneExtraction result = extract_planes(depth, vga_camera());
    EXPECT_EQ(result.planes.size(), side == 40 ? 2U : 0U);
    for (const PlaneFeature& found : result.planes) {
      EXPECT_LT(angle_degrees(found.plane.normal, {0, 0, -1}), 0.01);
      EXPECT_TRUE(std::abs(found.plane.distance - 1.5) < 1e-3 || std::abs(found.plane.distance - 2.5) < 1e-3);
    }
  }
}

class AnySize : public testing::TestWithParam<cv::Size> {};

TEST_P(AnySize, OnePlaneFillsTheImage) {
  PlaneScene scene{vga_camera(), {plane_through({0, 0, 2}, {0.3, -0.2, -1})}};
  const double scale = GetParam().width / 640.0;
  scene.camera.width = GetParam().width;
  scene.camera.height = GetParam().height;
  scene.camera.fx *= scale;
  scene.camera.fy *= scale;
  scene.camera.cx = 0.5 * (GetParam().width - 1);
  scene.camera.cy = 0.5 * (GetParam().height - 1);
  const PlaneExtraction result = extract_planes(scene.depth(), scene.camera);
  ASSERT_EQ(result.planes.size(), 1U);
  EXPECT_EQ(result.labels.size(), GetParam());
  EXPECT_EQ(result.planes[0].support, GetParam().area());
  EXPECT_LT(angle_degrees(result.planes[0].plane.normal, scene.planes[0].normal), 0.001);
}

INSTANTIATE_TEST_SUITE_P(Sizes, AnySize,
                         testing::Values(cv::Size(64, 48), cv::Size(163, 97), cv::Size(640, 480), cv::Size(1280, 720),
                                         cv::Size(4000, 3000)));

TEST(PlaneExtraction, LabelsHullCentroidAndCovarianceBelongTogether) {
  const PlaneScene scene = corner(525.0);
  base::Random random(3);
  cv::Mat depth = scene.depth();
  test::add_white_noise(depth, random);
  depth(cv::Rect(100, 100, 60, 40)) = std::numeric_limits<float>::quiet_NaN();
  const PlaneExtraction result = extract_planes(depth, scene.camera);
  ASSERT_EQ(result.planes.size(), 3U);
  EXPECT_EQ(cv::countNonZero(result.labels(cv::Rect(100, 100, 60, 40))), 0);
  for (std::size_t i = 0; i < result.planes.size(); ++i) {
    const PlaneFeature& found = result.planes[i];
    if (i > 0) {
      EXPECT_GE(result.planes[i - 1].support, found.support);
    }
    EXPECT_EQ(cv::countNonZero(result.labels == static_cast<double>(i + 1)), found.support);
    EXPECT_NEAR(found.plane.signed_distance(found.centroid), 0, 1e-9);
    EXPECT_GE(found.hull.size(), 3U);
    EXPECT_LE(found.hull.size(), static_cast<std::size_t>(kMaxHullPoints));
    for (const Eigen::Vector3d& corner_point : found.hull) {
      EXPECT_NEAR(found.plane.signed_distance(corner_point), 0, 1e-5);
      EXPECT_GT(corner_point.z(), 0);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(found.covariance);
    EXPECT_NEAR(eigen.eigenvalues()[0], 0, 1e-12);
    EXPECT_GT(eigen.eigenvalues()[1], 1e-10);
    Eigen::Vector4d along_normal = Eigen::Vector4d::Zero();
    along_normal.head<3>() = found.plane.normal;
    EXPECT_LT((found.covariance * along_normal).norm(), 1e-12);
  }
}

TEST(PlaneExtraction, WallBehindAPillarIsOnePlane) {
  const PlaneScene wall{vga_camera(), {plane_through({0, 0, 3}, {0.2, 0, -1})}};
  base::Random random(5);
  cv::Mat depth = wall.depth();
  depth(cv::Rect(280, 0, 80, 480)) = 1.5F;
  test::add_white_noise(depth, random);
  const PlaneExtraction result = extract_planes(depth, wall.camera);
  ASSERT_EQ(result.planes.size(), 2U);
  EXPECT_GT(result.planes[0].support, 0.98 * 560 * 480);
  EXPECT_LT(angle_degrees(result.planes[0].plane.normal, wall.planes[0].normal), 0.05);
}

TEST(PlaneExtraction, StepOfTwelveSigmaSeparatesParallelPlanes) {
  base::Random random(6);
  const double z = 2.0;
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(z));
  depth(cv::Rect(200, 120, 240, 240)) = static_cast<float>(z - 12 * geometry::depth_sigma(z));
  test::add_white_noise(depth, random);
  const PlaneExtraction result = extract_planes(depth, vga_camera());
  ASSERT_EQ(result.planes.size(), 2U);
  EXPECT_NEAR(result.planes[1].support, 240 * 240, 0.03 * 240 * 240);
  for (const PlaneFeature& found : result.planes) EXPECT_LT(angle_degrees(found.plane.normal, {0, 0, -1}), 0.1);
}

TEST(PlaneExtraction, WavyWallIsOnePlane) {
  base::Random random(8);
  cv::Mat depth(480, 640, CV_32FC1);
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) depth.at<float>(v, u) = static_cast<float>(1.8 + 0.012 * std::sin(u / 40.0));
  }
  test::add_white_noise(depth, random);
  const PlaneExtraction result = extract_planes(depth, vga_camera());
  ASSERT_EQ(result.planes.size(), 1U);
  EXPECT_LT(angle_degrees(result.planes[0].plane.normal, {0, 0, -1}), 0.5);
}

TEST(PlaneExtraction, ExtractorGivesTheSameAfterOtherImages) {
  const PlaneScene scene = corner(525.0);
  PlaneExtractor extractor;
  const PlaneExtraction fresh = extractor.extract(scene.depth(), scene.camera);
  (void)extractor.extract(cv::Mat(97, 163, CV_32FC1, cv::Scalar(1.0)), scene.camera);
  const PlaneExtraction again = extractor.extract(scene.depth(), scene.camera);
  ASSERT_EQ(fresh.planes.size(), again.planes.size());
  EXPECT_EQ(cv::countNonZero(fresh.labels != again.labels), 0);
  for (std::size_t i = 0; i < fresh.planes.size(); ++i) {
    EXPECT_EQ(fresh.planes[i].plane.normal, again.planes[i].plane.normal);
    EXPECT_EQ(fresh.planes[i].covariance, again.planes[i].covariance);
  }
}

TEST(PlaneOptions, NamesTheOptionThatIsOutOfRange) {
  EXPECT_TRUE(validate(PlaneOptions{}).has_value());
  PlaneOptions options;
  options.min_support_fraction = 2.0;
  ASSERT_FALSE(validate(options).has_value());
  EXPECT_NE(validate(options).error().message.find("min_support_fraction"), std::string::npos);
  options = {};
  options.max_error = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(validate(options).has_value());
}

/// Rays that run along the floor or above its horizon: their pixels are labelled, for in blocks of eight by eight some
/// belong to what stands behind.
TEST(PlaneHull, EndsAtTheReadingsWhereRaysDoNotMeetThePlane) {
  constexpr double kWall = 6.0;  // metres from the camera, which is 1 m above the floor
  const geometry::CameraModel camera = vga_camera(525.0);
  cv::Mat depth(camera.height, camera.width, CV_32FC1);
  for (int v = 0; v < depth.rows; ++v) {
    const double below = camera.ray({0, v}).y();
    depth.row(v).setTo(below > 1.0 / kWall ? 1.0 / below : kWall);
  }
  BlockGrid grid;
  const PlaneOptions options;
  build_blocks(depth, camera, options, PlaneTolerance(camera, 1.0, 64.0, {}), grid);
  std::vector<PlaneFeature> floor(1);
  floor[0].plane = plane_through({0, 1, 3}, {0, -1, 0});
  floor[0].centroid = {0, 1, 3};
  cv::Mat labels(depth.size(), CV_8UC1, cv::Scalar(0));
  labels.rowRange(static_cast<int>(camera.cy) - 3, depth.rows).setTo(1);  // three rows above the horizon and below
  add_hulls(labels, grid, floor);
  ASSERT_GE(floor[0].hull.size(), 4U);
  double farthest = 0.0;
  for (const Eigen::Vector3d& corner : floor[0].hull) {
    EXPECT_GT(corner.z(), 0.5);
    EXPECT_NEAR(corner.y(), 1.0, 1e-3) << "on the plane";
    farthest = std::max(farthest, corner.z());
  }
  EXPECT_NEAR(farthest, kWall, 4.0 * geometry::depth_sigma(kWall));
}

}  // namespace
}  // namespace eg::features
