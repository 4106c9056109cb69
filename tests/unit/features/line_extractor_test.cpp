#include "common/features/line_extractor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "common/base/random.hpp"
#include "common/features/line_descriptor.hpp"
#include "common/features/line_refiner.hpp"
#include "common/geometry/depth_noise.hpp"
#include "common/geometry/so3.hpp"

namespace eg::features {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

geometry::CameraModel camera(double fy = 500.0) {
  return {"test", 640, 480, 500.0, fy, 319.5, 239.5, {}, 5000.0, 30.0};
}

/// An edge through `through` with unit normal `normal`: dark on one side, bright on the other, the pixel's share
/// between.
cv::Mat edge_image(const Vector2d& through, const Vector2d& normal, double noise = 0.0, std::uint64_t seed = 1) {
  base::Random random(seed);
  cv::Mat image(480, 640, CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double share = 0.5 * (1.0 + std::erf(normal.dot(Vector2d(x, y) - through) / (0.7 * std::numbers::sqrt2)));
      image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(60.0 + 120.0 * share + noise * random.normal());
    }
  }
  return image;
}

/// Depth of the plane through `point` with `normal`, with sensor noise if asked.
cv::Mat plane_depth(const geometry::CameraModel& model, const Vector3d& point, const Vector3d& normal,
                    base::Random* random = nullptr) {
  cv::Mat depth(model.height, model.width, CV_32FC1, cv::Scalar(0.0F));
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const double z = normal.dot(point) / normal.dot(model.ray({x, y}));
      if (!(z > 0.3 && z < 8.0)) continue;
      depth.at<float>(y, x) =
          static_cast<float>(z + (random != nullptr ? geometry::depth_sigma(z) * random->normal() : 0.0));
    }
  }
  return depth;
}

double max_offset(const Segment& segment, const Vector2d& through, const Vector2d& normal) {
  return std::max(std::abs(normal.dot(segment.start - through)), std::abs(normal.dot(segment.end - through)));
}

class LineDetectors : public ::testing::TestWithParam<LineDetectorKind> {};

TEST_P(LineDetectors, FindAnEdgeWithinATenthOfAPixel) {
  LineExtractorOptions options;
  options.detector.kind = GetParam();
  for (const double degrees : {0.0, 17.0, 45.0, 80.0, 90.0, 133.0, 200.0, 301.0}) {
    const double angle = degrees * std::numbers::pi / 180.0;
    const Vector2d normal(std::cos(angle), std::sin(angle));
    const Vector2d through(320.3, 240.7);
    const cv::Mat image = edge_image(through, normal, 2.0);
    const auto lines = extract_lines(image, cv::Mat(480, 640, CV_32FC1, cv::Scalar(0.0F)), camera(), options);
    ASSERT_EQ(lines.size(), 1U) << degrees;
    EXPECT_GT(lines[0].segment.length(), 350.0);
    EXPECT_LT(max_offset(lines[0].segment, through, normal), 0.1) << degrees;
    EXPECT_GT(lines[0].segment.normal().dot(normal), 0.99) << "the bright side is on the right";
    EXPECT_FALSE(lines[0].feature.has_depth);
  }
}

TEST_P(LineDetectors, SurviveAnyImage) {
  LineExtractorOptions options;
  options.detector.kind = GetParam();
  base::Random random(4);
  for (const cv::Size size :
       {cv::Size(1, 1), cv::Size(1, 300), cv::Size(16, 16), cv::Size(333, 17), cv::Size(640, 480)}) {
    cv::Mat noise(size, CV_8UC1);
    noise.forEach<std::uint8_t>(
        [](std::uint8_t& p, const int* at) { p = static_cast<std::uint8_t>(at[0] * 37 + at[1] * 91); });
    cv::Mat board(size, CV_8UC1);
    board.forEach<std::uint8_t>(
        [](std::uint8_t& p, const int* at) { p = (at[0] / 20 + at[1] / 20) % 2 != 0 ? 255 : 0; });
    for (const cv::Mat& image :
         {cv::Mat(size, CV_8UC1, cv::Scalar(0)), cv::Mat(size, CV_8UC1, cv::Scalar(255)), noise, board}) {
      const auto lines = extract_lines(image, cv::Mat(size, CV_32FC1, cv::Scalar(NAN)), camera(), options);
      EXPECT_LE(lines.size(), 300U);
      for (const MeasuredLine& line : lines)
        EXPECT_TRUE(line.segment.start.allFinite() && line.segment.end.allFinite());
    }
  }
  EXPECT_TRUE(extract_lines({}, {}, camera(), options).empty());
}

INSTANTIATE_TEST_SUITE_P(Kinds, LineDetectors, ::testing::Values(LineDetectorKind::lsd, LineDetectorKind::edlines));

TEST(LineRefiner, ReportsAnHonestSigma) {
  double squares = 0.0;
  int count = 0;
  for (int trial = 0; trial < 60; ++trial) {
    base::Random random(static_cast<std::uint64_t>(trial));
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Vector2d normal(std::cos(angle), std::sin(angle));
    const Vector2d along(-normal.y(), normal.x());
    const Vector2d through(320.0 + random.uniform(), 240.0 + random.uniform());
    const cv::Mat image = edge_image(through, normal, 6.0, static_cast<std::uint64_t>(trial));
    const Segment segment{through - 30.0 * along + 0.7 * normal, through + 30.0 * along - 0.5 * normal};
    const Segment refined = refine_segment(image, segment);
    for (const Vector2d& end : {refined.start, refined.end}) {
      const double error = normal.dot(end - through) / refined.sigma;
      squares += error * error;
      ++count;
    }
  }
  EXPECT_GT(squares / count, 0.4);
  EXPECT_LT(squares / count, 2.0);
}

TEST(LineMerger, JoinsPiecesOfOneEdgeOnly) {
  const Segment left{{100, 100}, {160, 100}};
  const Segment right{{165, 100.2}, {230, 100.1}};
  const Segment beside{{165, 104}, {230, 104}};
  const Segment opposite{{230, 100}, {165, 100}};
  EXPECT_EQ(merge_collinear({left, right}, {}).size(), 1U);
  EXPECT_NEAR(merge_collinear({right, left}, {}).front().length(), 130.0, 0.1);
  EXPECT_EQ(merge_collinear({left, beside}, {}).size(), 2U);
  EXPECT_EQ(merge_collinear({left, opposite}, {}).size(), 2U) << "the other side of a thin thing";
  EXPECT_TRUE(merge_collinear({}, {}).empty());
}

TEST(LineLifter, IsExactOnASlantedPlaneInAnyCamera) {
  for (const double fy : {500.0, -480.0}) {
    const geometry::CameraModel model = camera(fy);
    const cv::Mat depth = plane_depth(model, {0, 0, 2}, Vector3d(0.4, -0.3, -0.8).normalized());
    const Segment segment{{150.0, 120.0}, {480.0, 300.0}, 0.1};
    const auto line = lift_line(segment, depth, model, {}, 1);
    ASSERT_TRUE(line);
    const Vector3d normal = Vector3d(0.4, -0.3, -0.8).normalized();
    EXPECT_NEAR(normal.dot(line->start - Vector3d(0, 0, 2)), 0.0, 2e-3);
    EXPECT_NEAR(normal.dot(line->end - Vector3d(0, 0, 2)), 0.0, 2e-3);
    EXPECT_LT((model.project(line->start) - segment.start).norm(), 1e-6);
    EXPECT_LT((model.project(line->end) - segment.end).norm(), 1e-6);
    const Vector3d start = model.ray(segment.start) * normal.z() * 2.0 / normal.dot(model.ray(segment.start));
    const Vector3d end = model.ray(segment.end) * normal.z() * 2.0 / normal.dot(model.ray(segment.end));
    EXPECT_LT(geometry::axial_angle(line->direction, end - start), 1e-3);
  }
}

TEST(LineLifter, TheNearerSurfaceOwnsADepthEdge) {
  const geometry::CameraModel model = camera();
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(3.0F));
  depth.colRange(0, 320).setTo(1.5F);
  for (const bool turned : {false, true}) {
    Segment segment{{320.0, 100.0}, {320.0, 380.0}, 0.1};
    if (turned) std::swap(segment.start, segment.end);
    const auto line = lift_line(segment, depth, model, {}, 1);
    ASSERT_TRUE(line);
    EXPECT_NEAR(line->start.z(), 1.5, 1e-3);
    EXPECT_NEAR(line->end.z(), 1.5, 1e-3);
  }
}

TEST(LineLifter, TakesTheSlopeOutBesideAnEdge) {
  // A table's top, seen from above, ends at the segment; what is behind has no depth. Read beside the edge alone, the
  // edge would lie too near.
  const geometry::CameraModel model = camera();
  const Vector3d normal(0, -1, 0);
  cv::Mat depth = plane_depth(model, {0, 0.5, 0}, normal);
  const double row = 320.5;
  depth.rowRange(0, 321).setTo(0.0F);
  const auto line = lift_line({{200.0, row}, {440.0, row}, 0.1}, depth, model, {}, 1);
  ASSERT_TRUE(line);
  const double z = 0.5 / model.ray({320.0, row}).y();
  EXPECT_NEAR(line->start.z(), z, 0.01);
  EXPECT_NEAR(line->end.z(), z, 0.01);
}

TEST(LineLifter, NeedsDepthThatAgrees) {
  const geometry::CameraModel model = camera();
  const Segment segment{{100, 100}, {300, 200}, 0.1};
  EXPECT_FALSE(lift_line(segment, cv::Mat(480, 640, CV_32FC1, cv::Scalar(0.0F)), model, {}, 1));
  EXPECT_FALSE(lift_line(segment, cv::Mat(480, 640, CV_32FC1, cv::Scalar(NAN)), model, {}, 1));
  cv::Mat random_depth(480, 640, CV_32FC1);
  base::Random random(1);
  for (int i = 0; i < random_depth.rows * random_depth.cols; ++i) {
    random_depth.at<float>(i / 640, i % 640) = static_cast<float>(random.uniform(0.5, 6.0));
  }
  EXPECT_FALSE(lift_line(segment, random_depth, model, {}, 1));
  EXPECT_FALSE(lift_line({{630, 470}, {700, 520}, 0.1}, cv::Mat(480, 640, CV_32FC1, cv::Scalar(1.0F)), model, {}, 1))
      << "most of it is outside of the image";
}

/// Mean of the normalised squared errors of end point depths and of the direction within its plane, both expected 1.
TEST(LineLifter, CovariancesAreConsistentUnderSensorNoise) {
  const geometry::CameraModel model = camera();
  LineLifterOptions options;
  options.direction_sigma_floor = 0.0;
  double depth_squares = 0.0;
  double angle_squares = 0.0;
  int count = 0;
  for (std::uint64_t trial = 0; trial < 60; ++trial) {
    base::Random random(trial + 100);
    const Vector3d normal = Vector3d(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), -1.0).normalized();
    const Vector3d point(0, 0, random.uniform(1.0, 3.5));
    const cv::Mat depth = plane_depth(model, point, normal, &random);
    for (int k = 0; k < 10; ++k) {
      const Segment segment{{random.uniform(20, 300), random.uniform(20, 460)},
                            {random.uniform(340, 620), random.uniform(20, 460)},
                            1e-6};
      const auto line = lift_line(segment, depth, model, options, trial);
      ASSERT_TRUE(line);
      const auto truth = [&](const Vector2d& pixel) {
        return Vector3d(model.ray(pixel) * normal.dot(point) / normal.dot(model.ray(pixel)));
      };
      const Vector3d span = truth(segment.end) - truth(segment.start);
      // Depth alone: the slide of the end point along the line is taken out of the covariance.
      options.end_slide_sigma = 0.0;
      const auto without_slide = lift_line(segment, depth, model, options, trial);
      const double z_error = without_slide->start.z() - truth(segment.start).z();
      depth_squares += z_error * z_error / without_slide->start_covariance(2, 2);
      const Vector3d sideways =
          model.ray(segment.start).cross(model.ray(segment.end)).normalized().cross(span.normalized());
      const double turn = sideways.dot(line->direction) / line->direction_sigma;
      angle_squares += turn * turn;
      ++count;
    }
  }
  EXPECT_GT(depth_squares / count, 0.5);
  EXPECT_LT(depth_squares / count, 2.0);
  EXPECT_GT(angle_squares / count, 0.5);
  EXPECT_LT(angle_squares / count, 2.0);
}

TEST(LineDescriptor, RecognisesSegmentsInATurnedImage) {
  base::Random random(9);
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(128));
  std::vector<Segment> segments;
  for (int i = 0; i < 300; ++i) {
    const cv::Rect box(random.index(600), random.index(440), 5 + random.index(60), 5 + random.index(60));
    cv::rectangle(image, box, cv::Scalar(random.index(256)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, {5, 5}, 1.0);
  cv::Mat turned;
  const cv::Mat warp = cv::getRotationMatrix2D({320.0F, 240.0F}, 12.0, 1.0);
  cv::warpAffine(image, turned, warp, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  for (int i = 0; i < 80; ++i) {
    const Vector2d start(random.uniform(160, 480), random.uniform(140, 340));
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    segments.push_back({start, start + random.uniform(30, 90) * Vector2d(std::cos(angle), std::sin(angle))});
  }
  const auto move = [&](const Vector2d& p) {
    const cv::Mat moved = warp * cv::Mat(cv::Vec3d(p.x(), p.y(), 1.0));
    return Vector2d(moved.at<double>(0), moved.at<double>(1));
  };
  GradientImages before;
  GradientImages after;
  compute_gradients(image, before);
  compute_gradients(turned, after);
  int right = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Descriptor moved = describe_segment(after, {move(segments[i].start), move(segments[i].end)});
    std::size_t best = 0;
    int best_distance = 257;
    for (std::size_t j = 0; j < segments.size(); ++j) {
      const int distance = hamming_distance(moved, describe_segment(before, segments[j]));
      if (distance < best_distance) {
        best = j;
        best_distance = distance;
      }
    }
    right += best == i ? 1 : 0;
  }
  EXPECT_GT(right, 74) << "of 80";
}

TEST(LineExtractor, RefusesOptionsOutOfRange) {
  EXPECT_TRUE(validate(LineExtractorOptions{}));
  LineExtractorOptions options;
  options.max_lines = kMaxLines + 1;
  EXPECT_FALSE(validate(options));
  options = {};
  options.lifter.min_inlier_ratio = 0.0;
  EXPECT_FALSE(validate(options));
}

}  // namespace
}  // namespace eg::features
