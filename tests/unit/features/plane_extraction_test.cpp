#include "common/features/plane_extraction.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <opencv2/core.hpp>

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
  geometry::CameraModel camera = vga_camera();
  EXPECT_TRUE(extract_planes(cv::Mat(0, 0, CV_32FC1), camera).planes.empty());
  EXPECT_TRUE(extract_planes(cv::Mat(1, 1, CV_32FC1, cv::Scalar(1.0)), camera).planes.empty());
  EXPECT_TRUE(extract_planes(cv::Mat::zeros(480, 640, CV_32FC1), camera).planes.empty());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(extract_planes(cv::Mat(480, 640, CV_32FC1, cv::Scalar(nan)), camera).planes.empty());
}

}  // namespace
}  // namespace eg::features
