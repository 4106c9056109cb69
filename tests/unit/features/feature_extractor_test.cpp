#include "common/features/feature_extractor.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/base/random.hpp"
#include "common/geometry/so3.hpp"

namespace eg::features {
namespace {

geometry::CameraModel camera(int width, int height, double fy_sign = 1.0) {
  const double focal = 0.8 * width;
  return {"test", width, height, focal, fy_sign * focal, 0.5 * (width - 1), 0.5 * (height - 1), {}, 5000.0, 30.0};
}

/// The inside of a box: walls of different brightness with a grid of joints, seen from a turned camera.
image::RectifiedFrame room_frame(const geometry::CameraModel& model, const Eigen::Matrix3d& room_from_camera) {
  const Eigen::Array3d half(2.0, 1.5, 2.5);
  image::RectifiedFrame frame{
      {1, 2, 3}, model, cv::Mat(model.height, model.width, CV_8UC3), cv::Mat(model.height, model.width, CV_32FC1)};
  for (int y = 0; y < model.height; ++y) {
    for (int x = 0; x < model.width; ++x) {
      const Eigen::Array3d ray = (room_from_camera * model.ray({x, y})).array();
      const Eigen::Array3d reach = half / ray.abs();
      Eigen::Index wall = 0;
      const double scale = reach.minCoeff(&wall);
      const Eigen::Array3d point = scale * ray;
      double grey = 90.0 + 35.0 * static_cast<double>(wall) + (ray[wall] > 0 ? 50.0 : 0.0);
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double in_tile = std::abs(std::remainder(point[axis], 0.5));
        if (axis != wall && in_tile < 0.02) grey *= 0.4;
      }
      frame.colour.at<cv::Vec3b>(y, x) = cv::Vec3b::all(cv::saturate_cast<std::uint8_t>(grey));
      frame.depth.at<float>(y, x) = static_cast<float>(scale);
    }
  }
  return frame;
}

Eigen::Matrix3d turned() { return geometry::so3_exp(Eigen::Vector3d(0.3, -0.5, 0.1)); }

void expect_same(const FrameFeatures& a, const FrameFeatures& b) {
  ASSERT_EQ(a.points.size(), b.points.size());
  ASSERT_EQ(a.lines.size(), b.lines.size());
  ASSERT_EQ(a.planes.size(), b.planes.size());
  ASSERT_EQ(a.directions.size(), b.directions.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].pixel, b.points[i].pixel);
    EXPECT_EQ(a.points[i].descriptor, b.points[i].descriptor);
  }
  for (std::size_t i = 0; i < a.lines.size(); ++i) {
    EXPECT_EQ(a.lines[i].start, b.lines[i].start);
    EXPECT_EQ(a.lines[i].end_covariance, b.lines[i].end_covariance);
    EXPECT_EQ(a.lines[i].descriptor, b.lines[i].descriptor);
    EXPECT_EQ(a.lines[i].direction, b.lines[i].direction);
  }
  for (std::size_t i = 0; i < a.directions.size(); ++i) {
    EXPECT_EQ(a.directions[i].direction, b.directions[i].direction);
    EXPECT_EQ(a.directions[i].covariance, b.directions[i].covariance);
  }
}

TEST(FeatureExtractor, FindsTheDirectionsOfARoom) {
  for (const double fy_sign : {1.0, -1.0}) {
    const Eigen::Matrix3d room_from_camera = turned();
    FeatureExtractor extractor;
    const FrameFeatures features = extractor.extract(room_frame(camera(640, 480, fy_sign), room_from_camera));
    EXPECT_EQ(features.header.sequence, 2);
    EXPECT_GT(features.points.size(), 100U);
    EXPECT_GE(features.planes.size(), 3U);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d expected = room_from_camera.transpose().col(axis);
      double vanishing = 10.0;
      double normal = 10.0;
      for (const DirectionFeature& direction : features.directions) {
        double& nearest = direction.kind == DirectionKind::plane_normal ? normal : vanishing;
        nearest = std::min(nearest, geometry::axial_angle(direction.direction, expected));
      }
      EXPECT_LT(vanishing, 0.003) << "axis " << axis;
      EXPECT_LT(normal, 0.003) << "axis " << axis;
    }
  }
}

TEST(FeatureExtractor, DirectionsAndTheirSourcesPointToEachOther) {
  FeatureExtractor extractor;
  const FrameFeatures features = extractor.extract(room_frame(camera(640, 480), turned()));
  ASSERT_GE(features.directions.size(), features.planes.size());
  for (std::size_t i = 0; i < features.directions.size(); ++i) {
    const DirectionFeature& direction = features.directions[i];
    EXPECT_EQ(i < features.planes.size(), direction.kind == DirectionKind::plane_normal);
    if (direction.kind == DirectionKind::plane_normal) {
      EXPECT_EQ(direction.source, static_cast<int>(i));
      continue;
    }
    int lines = 0;
    for (const LineFeature& line : features.lines) lines += line.direction == static_cast<int>(i) ? 1 : 0;
    EXPECT_EQ(lines, direction.support);
  }
  EXPECT_EQ(extractor.plane_labels().size(), cv::Size(640, 480));
}

TEST(FeatureExtractor, ADarkSeamAtTheBorderOfTheImageIsNoLine) {
  image::RectifiedFrame frame = room_frame(camera(640, 480), turned());
  frame.colour.colRange(638, 640).setTo(cv::Scalar::all(5));
  frame.colour.rowRange(0, 2).setTo(cv::Scalar::all(5));
  for (const LineFeature& line : FeatureExtractor().extract(frame).lines) {
    EXPECT_LT(std::min(line.start_pixel.x(), line.end_pixel.x()), 634.0);
    EXPECT_GT(std::max(line.start_pixel.y(), line.end_pixel.y()), 5.0);
  }
}

TEST(FeatureExtractor, TheResultDoesNotDependOnThreadsOrOnEarlierFrames) {
  const image::RectifiedFrame frame = room_frame(camera(640, 480), turned());
  FeatureExtractor extractor;
  const FrameFeatures first = extractor.extract(frame);
  (void)extractor.extract(room_frame(camera(320, 240), Eigen::Matrix3d::Identity()));
  for (const std::size_t threads : {1U, 2U, 4U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    expect_same(first, extractor.extract(frame));
    expect_same(first, FeatureExtractor().extract(frame));
  }
}

cv::Mat random_colour(const cv::Size& size, base::Random& random) {
  cv::Mat colour(size, CV_8UC3);
  for (int i = 0; i < size.area(); ++i) {
    colour.at<cv::Vec3b>(i / size.width, i % size.width) = cv::Vec3b::all(static_cast<std::uint8_t>(random.index(256)));
  }
  return colour;
}

cv::Mat checkerboard(const cv::Size& size) {
  cv::Mat colour(size, CV_8UC3);
  for (int i = 0; i < size.area(); ++i) {
    const bool white = (i / size.width / 8 + i % size.width / 8) % 2 == 0;
    colour.at<cv::Vec3b>(i / size.width, i % size.width) = cv::Vec3b::all(white ? 255 : 0);
  }
  return colour;
}

/// Depth anywhere between half a metre and five.
cv::Mat random_depth(const cv::Size& size, base::Random& random) {
  cv::Mat depth(size, CV_32FC1);
  for (int i = 0; i < size.area(); ++i) {
    depth.at<float>(i / size.width, i % size.width) = static_cast<float>(random.uniform(0.5, 5.0));
  }
  return depth;
}

TEST(FeatureExtractor, SurvivesFramesThatShowNothing) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  base::Random random(1);
  FeatureExtractor extractor;
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(20, 3), cv::Size(320, 240)}) {
    const cv::Mat wall(size, CV_32FC1, cv::Scalar(2.0));
    const std::vector<cv::Mat> depths = {cv::Mat(size, CV_32FC1, cv::Scalar(0.0)),
                                         cv::Mat(size, CV_32FC1, cv::Scalar(kNan)),
                                         cv::Mat(size, CV_32FC1, cv::Scalar(-1.0)), random_depth(size, random), wall};
    for (const cv::Mat& colour :
         {cv::Mat(size, CV_8UC3, cv::Scalar::all(0)), random_colour(size, random), checkerboard(size)}) {
      for (const cv::Mat& depth : depths) {
        const auto features = extractor.extract({{}, camera(size.width, size.height), colour, depth});
        for (const DirectionFeature& direction : features.directions) EXPECT_TRUE(direction.covariance.allFinite());
        EXPECT_TRUE(depth.data == wall.data || features.planes.empty());
      }
    }
  }
  EXPECT_TRUE(extractor.extract({{}, camera(1, 1), {}, {}}).points.empty());
}

TEST(FeatureExtractor, SurvivesLargeFramesThatShowNothing) {
  base::Random random(2);
  const cv::Size size(4000, 3000);
  FeatureExtractor extractor;
  const auto noise =
      extractor.extract({{}, camera(size.width, size.height), random_colour(size, random), random_depth(size, random)});
  EXPECT_TRUE(noise.planes.empty());
  const auto nothing =
      extractor.extract({{},
                         camera(size.width, size.height),
                         cv::Mat(size, CV_8UC3, cv::Scalar::all(0)),
                         cv::Mat(size, CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()))});
  EXPECT_TRUE(nothing.points.empty() && nothing.lines.empty() && nothing.planes.empty() && nothing.directions.empty());
}

TEST(FeatureExtractor, TakesLargeFrames) {
  const FrameFeatures features = FeatureExtractor().extract(room_frame(camera(4000, 3000), turned()));
  EXPECT_GE(features.planes.size(), 3U);
  EXPECT_GT(features.lines.size(), 10U);
}

TEST(FeatureExtractor, NamesTheOptionThatIsOutOfRange) {
  FeatureExtractorOptions options;
  EXPECT_TRUE(validate(options));
  options.lines.max_lines = -1;
  const auto status = validate(options);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("lines.max_lines"), std::string::npos);
}

}  // namespace
}  // namespace eg::features
