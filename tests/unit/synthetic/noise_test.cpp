#include "common/synthetic/noise.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>
#include <set>

#include "common/synthetic/depth_encoding.hpp"
#include "common/synthetic/sequence.hpp"

namespace eg::synthetic {
namespace {

const geometry::CameraModel kCamera = *geometry::find_camera("synthetic");

cv::Mat wall(float z) { return {480, 640, CV_32FC1, cv::Scalar(z)}; }

struct Statistics {
  double mean = 0.0;
  double sigma = 0.0;
  int count = 0;
};

Statistics statistics(const cv::Mat& depth) {
  double sum = 0.0;
  double sum_of_squares = 0.0;
  Statistics result;
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const double z = depth.at<float>(y, x);
      if (z <= 0) continue;
      sum += z;
      sum_of_squares += z * z;
      ++result.count;
    }
  }
  result.mean = sum / result.count;
  result.sigma = std::sqrt(sum_of_squares / result.count - result.mean * result.mean);
  return result;
}

double steps(const DepthNoiseOptions& options) { return options.steps_per_pixel * kCamera.fx * options.baseline; }

TEST(DepthNoise, IsQuantisedToEighthsOfAPixelOfDisparity) {
  const DepthNoiseOptions options;
  const cv::Mat noisy = add_depth_noise(wall(3.0F), kCamera, options, 1);
  std::set<float> values;
  for (int x = 0; x < 640; ++x) values.insert(noisy.at<float>(200, x));
  EXPECT_LE(values.size(), 4U);
  for (const float z : values) {
    const double disparity = steps(options) / z;
    EXPECT_NEAR(disparity, std::round(disparity), 1e-3);
  }
}

TEST(DepthNoise, GrowsWithTheSquareOfTheDepth) {
  // Of a step in disparity, error and rounding have the variance sigma² + 1/12; dz = z² / k per step. Walls between two
  // steps and on one err differently, so that the mean over many depths is compared.
  DepthNoiseOptions options;
  options.disparity_sigma = 1.0;  // far above the rounding, for which uniform errors are then exact
  const double sigma_of_step = std::sqrt(1.0 + 1.0 / 12.0);
  for (const float z : {1.0F, 2.0F, 4.0F}) {
    const Statistics result = statistics(add_depth_noise(wall(z), kCamera, options, 2));
    EXPECT_EQ(result.count, 640 * 480);
    EXPECT_NEAR(result.sigma, sigma_of_step * z * z / steps(options), 0.03 * result.sigma) << z;
    EXPECT_NEAR(result.mean, z, 0.2 * result.sigma) << z;
  }
}

TEST(DepthNoise, LateralShiftsShowOnSlantedSurfacesOnly) {
  DepthNoiseOptions options;
  options.disparity_sigma = 0.0;
  options.steps_per_pixel = 1e4;  // next to no rounding
  options.grazing_start_deg = 80.0;
  const double tangent = 1.0;  // the surface falls away by 45 degrees: 1/z = (1 - tangent x) / 2
  cv::Mat slanted(480, 640, CV_32FC1);
  for (int x = 0; x < 640; ++x) {
    const double inverse = (1.0 - 0.5 * tangent * (x - kCamera.cx) / kCamera.fx) / 2.0;
    slanted.col(x).setTo(1.0 / inverse);
  }
  const cv::Mat flat_noisy = add_depth_noise(wall(2.0F), kCamera, options, 3);
  EXPECT_LT(statistics(flat_noisy).sigma, 1e-3);
  const cv::Mat noisy = add_depth_noise(slanted, kCamera, options, 3);
  const Statistics difference = statistics(1.0 + noisy.col(320) - slanted.col(320));
  // dz/dx = z² d(1/z)/dx, at the middle z = 2: 4 * 0.25 / fx per pixel.
  EXPECT_NEAR(difference.sigma, options.lateral_sigma * 1.0 / kCamera.fx, 0.15 * difference.sigma);
}

TEST(DepthNoise, LosesHalfOfThePixelsAtDepthEdgesAndNoOthers) {
  cv::Mat depth = wall(3.0F);
  depth.colRange(320, 640).setTo(2.0);
  const cv::Mat noisy = add_depth_noise(depth, kCamera, {}, 4);
  const int at_edge = cv::countNonZero(noisy.colRange(319, 321));
  EXPECT_NEAR(at_edge, 480, 80);
  EXPECT_EQ(cv::countNonZero(noisy.colRange(0, 319)), 319 * 480);
  EXPECT_EQ(cv::countNonZero(noisy.colRange(321, 640)), 319 * 480);
}

TEST(DepthNoise, GivesNothingOutOfRange) {
  for (const float z : {0.3F, 8.5F, 0.0F})
    EXPECT_EQ(cv::countNonZero(add_depth_noise(wall(z), kCamera, {}, 5)), 0) << z;
}

TEST(DepthNoise, FailsAtGrazingAngles) {
  // A floor 1 m below the camera: 1/z = y, so that rows far down are steep and rows near the horizon are grazing.
  cv::Mat floor(480, 640, CV_32FC1, cv::Scalar(0));
  for (int y = 260; y < 480; ++y) floor.row(y).setTo(kCamera.fy / (y - kCamera.cy));
  DepthNoiseOptions options;
  options.max_depth = 100.0;
  options.edge_ratio = 1.3;  // rows near the horizon are far apart
  const cv::Mat noisy = add_depth_noise(floor, kCamera, options, 6);
  const auto angle_deg = [&](int y) { return 90.0 - std::atan((y - kCamera.cy) / kCamera.fy) * 180.0 / M_PI; };
  for (const int y : {270, 280}) {
    ASSERT_GT(angle_deg(y), options.grazing_end_deg);
    EXPECT_EQ(cv::countNonZero(noisy.row(y).colRange(300, 340)), 0) << y;
  }
  ASSERT_LT(angle_deg(470), options.grazing_start_deg);
  EXPECT_EQ(cv::countNonZero(noisy.row(470).colRange(300, 340)), 40);
}

TEST(DepthNoise, KeepsHolesAndTakesTinyImages) {
  cv::Mat depth = wall(2.0F);
  depth(cv::Rect(100, 100, 50, 50)).setTo(0);
  const cv::Mat noisy = add_depth_noise(depth, kCamera, {}, 7);
  EXPECT_EQ(cv::countNonZero(noisy(cv::Rect(105, 105, 40, 40))), 0);
  const cv::Mat one = add_depth_noise(cv::Mat(1, 1, CV_32FC1, cv::Scalar(2.0)), kCamera, {}, 8);
  EXPECT_NEAR(one.at<float>(0), 2.0, 0.1);
}

TEST(ColourNoise, HasTheVarianceOfReadAndShotNoise) {
  const ColourNoiseOptions options{.read_sigma = 2.0, .shot_gain = 0.05};
  for (const int value : {40, 120, 200}) {
    const cv::Mat noisy = add_colour_noise(cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(value)), options, 9);
    cv::Scalar mean, sigma;
    cv::meanStdDev(noisy, mean, sigma);
    const double expected = std::sqrt(4.0 + 0.05 * value + 1.0 / 12.0);
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(mean[channel], value, 0.05);
      EXPECT_NEAR(sigma[channel], expected, 0.02 * expected);
    }
  }
}

TEST(Noise, DependsOnSeedAndSequenceButNotOnThreads) {
  SequenceOptions options;
  options.scene = "corner";
  image::RgbdFrame frame = SyntheticSequence::make(options)->frame(3);
  const auto noisy_with = [&](std::size_t threads, std::uint64_t seed) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return add_noise(frame, {}, seed);
  };
  const auto same = [](const cv::Mat& a, const cv::Mat& b) {
    return std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
  };
  const image::RgbdFrame one = noisy_with(1, 5);
  const image::RgbdFrame two = noisy_with(2, 5);
  EXPECT_TRUE(same(one.colour, two.colour) && same(one.depth, two.depth));
  EXPECT_FALSE(same(one.colour, noisy_with(2, 6).colour));
  frame.header.sequence = 4;
  const image::RgbdFrame next = noisy_with(2, 5);
  EXPECT_FALSE(same(one.colour, next.colour));
  EXPECT_FALSE(same(one.depth, next.depth));
}

TEST(Noise, RejectsOptionsOutOfRange) {
  EXPECT_TRUE(validate(NoiseOptions{}).has_value());
  const auto rejected = [](auto change) {
    NoiseOptions options;
    change(options);
    return !validate(options).has_value();
  };
  EXPECT_TRUE(rejected([](NoiseOptions& o) { o.depth.baseline = 0; }));
  EXPECT_TRUE(rejected([](NoiseOptions& o) { o.depth.edge_dropout = 1.5; }));
  EXPECT_TRUE(rejected([](NoiseOptions& o) { o.depth.grazing_end_deg = 50; }));
  EXPECT_TRUE(rejected([](NoiseOptions& o) { o.depth.max_depth = 0.1; }));
  EXPECT_TRUE(rejected([](NoiseOptions& o) { o.depth.disparity_sigma = NAN; }));
  EXPECT_TRUE(rejected([](NoiseOptions& o) { o.colour.shot_gain = -1; }));
}

}  // namespace
}  // namespace eg::synthetic
