#include "common/features/point_extractor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <set>

#include "common/base/random.hpp"
#include "common/features/line_descriptor.hpp"
#include "common/features/point_depth.hpp"
#include "common/geometry/depth_noise.hpp"

namespace eg::features {
namespace {

/// Blobs of random size and brightness.
cv::Mat textured_image(int width, int height, std::uint64_t seed) {
  base::Random random(seed);
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(128));
  for (int i = 0; i < width * height / 400; ++i) {
    const cv::Rect box(random.index(width), random.index(height), 3 + random.index(20), 3 + random.index(20));
    cv::rectangle(image, box, cv::Scalar(random.index(256)), cv::FILLED);
  }
  return image;
}

cv::Mat flat_depth(const cv::Mat& image, float z) { return {image.size(), CV_32FC1, cv::Scalar(z)}; }

TEST(PointExtractor, FindsTheCornersOfASquareOnTheFinestLevel) {
  cv::Mat image(200, 200, CV_8UC1, cv::Scalar(40));
  cv::rectangle(image, {60, 70}, {139, 149}, cv::Scalar(220), cv::FILLED);
  cv::GaussianBlur(image, image, {5, 5}, 1.0);
  PointExtractorOptions options;
  options.detector.levels = 1;
  const auto points = extract_points(image, flat_depth(image, 2.0F), options);
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(60, 70), Eigen::Vector2d(139, 70), Eigen::Vector2d(60, 149), Eigen::Vector2d(139, 149)}) {
    double nearest = 1e9;
    for (const PointFeature& point : points) nearest = std::min(nearest, (point.pixel - corner).norm());
    EXPECT_LE(nearest, 2.0) << corner.transpose();
  }
}

/// A bright rectangle whose corners are not on whole pixels, as a camera sees it: every pixel is the mean of its area.
cv::Mat rectangle_between_pixels(const cv::Size& size, const Eigen::Vector2d& first, const Eigen::Vector2d& last) {
  constexpr int kParts = 10;
  cv::Mat fine(size * kParts, CV_8UC1, cv::Scalar(40));
  const auto to_fine = [](const Eigen::Vector2d& pixel) {
    return cv::Point(cvRound((pixel.x() + 0.5) * kParts), cvRound((pixel.y() + 0.5) * kParts));
  };
  fine(cv::Rect(to_fine(first), to_fine(last))).setTo(220);
  cv::Mat image;
  cv::resize(fine, image, size, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(image, image, {5, 5}, 0.8);
  return image;
}

TEST(PointExtractor, LocatesCornersToAFractionOfAPixel) {
  PointExtractorOptions options;
  options.detector.levels = 1;
  for (const double shift : {0.0, 0.1, 0.2, 0.8, 0.9}) {
    const Eigen::Vector2d first(60.0 + shift, 70.0 - shift);
    const Eigen::Vector2d last(139.0 - shift, 149.0 + shift);
    const cv::Mat image = rectangle_between_pixels({200, 220}, first, last);
    const auto points = extract_points(image, flat_depth(image, 2.0F), options);
    for (const Eigen::Vector2d& corner : {first, Eigen::Vector2d(last.x(), first.y()), last}) {
      double nearest = 1e9;
      for (const PointFeature& point : points) nearest = std::min(nearest, (point.pixel - corner).norm());
      EXPECT_LT(nearest, 0.35) << corner.transpose();
    }
  }
}

TEST(PointExtractor, LevelsAgreeOnWhereABlobIs) {
  // A bright disc gives corners on its rim on all levels; their mean must not wander with the level.
  cv::Mat image(240, 240, CV_8UC1, cv::Scalar(30));
  cv::rectangle(image, {100, 100}, {139, 139}, cv::Scalar(200), cv::FILLED);
  const auto points = extract_points(image, flat_depth(image, 2.0F));
  std::array<Eigen::Vector2d, 8> sum;
  sum.fill(Eigen::Vector2d::Zero());
  std::array<int, 8> count{};
  for (const PointFeature& point : points) {
    sum[static_cast<std::size_t>(point.octave)] += point.pixel;
    ++count[static_cast<std::size_t>(point.octave)];
  }
  for (std::size_t octave = 0; octave < 6; ++octave) {
    if (count[octave] < 4) continue;
    const Eigen::Vector2d mean = sum[octave] / count[octave];
    EXPECT_NEAR(mean.x(), 119.5, 1.0) << "octave " << octave;
    EXPECT_NEAR(mean.y(), 119.5, 1.0) << "octave " << octave;
  }
}

TEST(PointExtractor, WeakTextureIsNotStarvedByStrongTexture) {
  // The left half has hundreds of strong corners, the right half faint ones.
  cv::Mat image = textured_image(640, 480, 3);
  cv::Mat right = image(cv::Rect(320, 0, 320, 480));
  right.convertTo(right, CV_8UC1, 0.15, 110.0);
  PointExtractorOptions options;
  options.detector.max_points = 600;
  const auto points = extract_points(image, flat_depth(image, 2.0F), options);
  const auto in_right = std::count_if(points.begin(), points.end(), [](const auto& p) { return p.pixel.x() > 330; });
  EXPECT_EQ(points.size(), 600U);
  EXPECT_GT(in_right, 150);
}

TEST(PointExtractor, DescriptorsMatchInAShiftedAndTurnedView) {
  const cv::Mat image = textured_image(400, 400, 5);
  const Eigen::Vector2d centre(199.5, 199.5);
  const double angle = 30.0;
  cv::Mat turned;
  const cv::Mat warp = cv::getRotationMatrix2D({199.5F, 199.5F}, -angle, 1.0);
  cv::warpAffine(image, turned, warp, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  const auto a = extract_points(image, flat_depth(image, 2.0F));
  const auto b = extract_points(turned, flat_depth(turned, 2.0F));

  int right = 0;
  int matched = 0;
  for (const PointFeature& point : a) {
    if ((point.pixel - centre).norm() > 150.0) continue;
    const auto best = std::min_element(b.begin(), b.end(), [&](const auto& p, const auto& q) {
      return hamming_distance(p.descriptor, point.descriptor) < hamming_distance(q.descriptor, point.descriptor);
    });
    if (hamming_distance(best->descriptor, point.descriptor) > 40) continue;
    ++matched;
    const cv::Mat expected = warp * cv::Mat(cv::Vec3d(point.pixel.x(), point.pixel.y(), 1.0));
    const Eigen::Vector2d pixel(expected.at<double>(0), expected.at<double>(1));
    right += (best->pixel - pixel).norm() < 3.0 * best->pixel_sigma ? 1 : 0;
  }
  EXPECT_GT(matched, 50);
  EXPECT_GT(right, 0.9 * matched);
}

TEST(PointExtractor, SigmaGrowsWithTheLevelAndOrderIsByLevel) {
  const auto points = extract_points(textured_image(640, 480, 1), cv::Mat(480, 640, CV_32FC1, cv::Scalar(1.5F)));
  std::set<int> octaves;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_DOUBLE_EQ(points[i].pixel_sigma, std::pow(1.2, points[i].octave));
    EXPECT_GE(points[i].octave, i > 0 ? points[i - 1].octave : 0);
    EXPECT_FLOAT_EQ(points[i].depth, 1.5F);
    EXPECT_DOUBLE_EQ(points[i].depth_sigma, geometry::depth_sigma(points[i].depth));
    octaves.insert(points[i].octave);
  }
  EXPECT_EQ(octaves.size(), 8U);
  EXPECT_LE(points.size(), 1000U);
}

TEST(PointExtractor, SurvivesImagesWithoutCorners) {
  EXPECT_TRUE(extract_points({}, {}).empty());
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(37, 500), cv::Size(39, 39), cv::Size(640, 480)}) {
    const cv::Mat image(size, CV_8UC1, cv::Scalar(77));
    EXPECT_TRUE(extract_points(image, flat_depth(image, 1.0F)).empty());
  }
}

TEST(PointExtractor, RefusesOptionsOutOfRange) {
  PointExtractorOptions options;
  EXPECT_TRUE(validate(options));
  options.detector.scale_factor = 1.0;
  EXPECT_FALSE(validate(options));
  options = {};
  options.detector.max_points = kMaxPoints + 1;
  EXPECT_FALSE(validate(options));
}

TEST(ReadDepth, TakesThePixelOfASmoothSurface) {
  cv::Mat depth(5, 5, CV_32FC1, cv::Scalar(2.0F));
  depth.at<float>(2, 2) = 2.01F;
  EXPECT_FLOAT_EQ(static_cast<float>(read_depth(depth, 2, 2).depth), 2.01F);
}

TEST(ReadDepth, TakesTheNearerSurfaceAtAnEdge) {
  cv::Mat depth(5, 5, CV_32FC1, cv::Scalar(3.0F));
  depth.colRange(0, 2).setTo(1.0F);
  EXPECT_DOUBLE_EQ(read_depth(depth, 2, 2).depth, 1.0) << "three near neighbours";
  depth.setTo(3.0F);
  depth.at<float>(1, 1) = 1.0F;
  EXPECT_FALSE(read_depth(depth, 2, 2).valid()) << "one near pixel is a flying one";
}

TEST(ReadDepth, HasNoneInHolesBordersAndNaN) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(read_depth(cv::Mat(5, 5, CV_32FC1, cv::Scalar(0.0F)), 2, 2).valid());
  EXPECT_FALSE(read_depth(cv::Mat(5, 5, CV_32FC1, cv::Scalar(nan)), 2, 2).valid());
  EXPECT_FALSE(read_depth(cv::Mat(5, 5, CV_32FC1, cv::Scalar(1.0F)), 0, 2).valid());
  EXPECT_FALSE(read_depth(cv::Mat(5, 5, CV_32FC1, cv::Scalar(1.0F)), 9, 9).valid());
  cv::Mat hole(5, 5, CV_32FC1, cv::Scalar(2.0F));
  hole.at<float>(2, 2) = nan;
  EXPECT_DOUBLE_EQ(read_depth(hole, 2, 2).depth, 2.0);
}

}  // namespace
}  // namespace eg::features
