#include "common/features/plane_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/depth_noise.hpp"
#include "tests/support/plane_scenes.hpp"

namespace eg::features {
namespace {

/// A wall at 2 m with ripples of `amplitude` (standard deviations of a reading) in both directions.
cv::Mat rippled_wall(double amplitude) {
  constexpr double kDepth = 2.0;
  constexpr double kPixelsPerRadian = 18.0;
  const double height = amplitude * geometry::depth_sigma(kDepth);
  cv::Mat depth(480, 640, CV_32FC1);
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const double ripple = std::sin(u / kPixelsPerRadian) * std::sin(v / kPixelsPerRadian);
      depth.at<float>(v, u) = static_cast<float>(kDepth + height * ripple);
    }
  }
  return depth;
}

DepthErrors measure(const cv::Mat& depth) {
  const PlaneOptions options;
  const int block_size = block_size_of(options, depth.size());
  const PlaneTolerance tolerance(test::vga_camera(), options.lateral_sigma, block_size * block_size,
                                 {options.max_error});
  BlockGrid grid;
  build_blocks(depth, test::vga_camera(), options, tolerance, grid);
  return measure_depth_errors(grid, tolerance);
}

TEST(DepthErrors, AreAtTheirFloorsInAnExactImage) {
  const DepthErrors errors = measure(rippled_wall(0.0));
  EXPECT_DOUBLE_EQ(errors.noise, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(errors.waviness, 0.05);
  EXPECT_LT(errors.warp, 0.01);
}

TEST(DepthErrors, NoiseIsNoWarp) {
  base::Random random(1);
  cv::Mat depth = rippled_wall(0.0);
  test::add_white_noise(depth, random);
  const DepthErrors errors = measure(depth);
  EXPECT_NEAR(errors.noise, 1.0, 0.05);
  EXPECT_NEAR(errors.waviness, 0.1, 0.03);  // of the mean of 100 pixels
  EXPECT_LT(errors.warp, 0.05);
}

TEST(DepthErrors, RipplesAreWarp) {
  base::Random random(2);
  cv::Mat depth = rippled_wall(1.0);
  test::add_white_noise(depth, random);
  const DepthErrors errors = measure(depth);
  EXPECT_GT(errors.warp, 0.12);
  EXPECT_LE(errors.warp, errors.waviness);
}

TEST(DepthErrors, AreThoseOfASensorWhereNothingIsFlat) {
  const DepthErrors errors = measure(cv::Mat(480, 640, CV_32FC1, cv::Scalar(0.0)));
  EXPECT_DOUBLE_EQ(errors.noise, 1.0);
  EXPECT_DOUBLE_EQ(errors.waviness, 1.0);
  EXPECT_DOUBLE_EQ(errors.warp, 1.0);
}

TEST(DepthErrors, WarpMakesNormalsLessCertain) {
  base::Random random(3);
  const auto normal_variance = [&](double amplitude) {
    cv::Mat depth = rippled_wall(amplitude);
    test::add_white_noise(depth, random);
    const PlaneExtraction found = extract_planes(depth, test::vga_camera());
    return found.planes.size() == 1 ? found.planes[0].covariance.topLeftCorner<3, 3>().trace() : 0.0;
  };
  const double flat = normal_variance(0.0);
  EXPECT_GT(flat, 0.0);
  EXPECT_GT(normal_variance(1.0), 10.0 * flat);
}

/// Two halves of a wall, one 2 cm before the other: 1.4 standard deviations of one reading at 3 m.
TEST(DepthErrors, SmallStepsAreSeenUnderNoiseThatAveragesOut) {
  base::Random random(4);
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(3.0));
  depth.colRange(320, 640) = 2.98;
  test::add_white_noise(depth, random);
  EXPECT_EQ(extract_planes(depth, test::vga_camera()).planes.size(), 2U);
}

}  // namespace
}  // namespace eg::features
