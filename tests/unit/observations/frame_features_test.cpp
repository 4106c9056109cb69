#include "common/observations/frame_features.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/depth_noise.hpp"
#include "common/geometry/so3.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::observations {
namespace {

using features::FrameFeatures;

const geometry::CameraModel kCamera = *geometry::find_camera("icl");

LineObservation see_line(std::int32_t id, const Eigen::Vector3d& start, const Eigen::Vector3d& end) {
  return {id, kCamera.project(start), kCamera.project(end), start.z(), end.z()};
}

/// A frame that sees three lines along `direction` and one across it, all exactly.
Recording recording_of_lines(const Eigen::Vector3d& direction) {
  Recording recording;
  recording.frames.resize(1);
  std::int32_t id = 0;
  for (const Eigen::Vector3d& start : {Eigen::Vector3d(-0.8, -0.5, 2), Eigen::Vector3d(-0.9, 0.4, 2.5),
                                       Eigen::Vector3d(-0.2, 0.6, 3), Eigen::Vector3d(-0.7, -0.7, 2.2)}) {
    recording.frames[0].lines.push_back(see_line(id, start, start + 1.5 * direction));
    recording.line_groups[id] = 7;
    ++id;
  }
  recording.frames[0].lines.push_back(see_line(id, {0, 0, 2}, {0.1, 0.4, 2}));
  recording.line_groups[id] = 9;
  return recording;
}

TEST(FrameFeatures, PointsKeepTheirPixelsAndIdentities) {
  Recording recording;
  recording.frames.push_back({2.0, {}, {{42, {100.5, 200.25}, 3.0}, {7, {-0.5, 10}, 2.0}}, {}});
  SensorModel sensor;
  sensor.depth_noise = false;
  const FrameFeatures frame = features_of(recording, 0, kCamera, sensor);
  EXPECT_EQ(frame.header.utime, 2'000'000);
  ASSERT_EQ(frame.points.size(), 1U) << "the other is outside the image";
  EXPECT_EQ(frame.points[0].track_id, 42);
  EXPECT_EQ(frame.points[0].pixel, Eigen::Vector2d(100.5, 200.25));
  EXPECT_DOUBLE_EQ(frame.points[0].pixel_sigma, 1.0);
  EXPECT_DOUBLE_EQ(frame.points[0].depth, 3.0);
  EXPECT_DOUBLE_EQ(frame.points[0].depth_sigma, geometry::depth_sigma(3.0));
}

TEST(FrameFeatures, DepthsHaveTheNoiseOfTheSensor) {
  constexpr int kPoints = 4000;
  Recording recording;
  recording.frames.resize(1);
  for (int i = 0; i < kPoints; ++i) recording.frames[0].points.push_back({i, {320, 240}, 1.0 + 4.0 * i / kPoints});
  double sum = 0.0;
  double squares = 0.0;
  for (const auto& point : features_of(recording, 0, kCamera).points) {
    const double truth = recording.frames[0].points[static_cast<std::size_t>(point.track_id)].true_depth;
    const double error = (point.depth - truth) / point.depth_sigma;
    sum += error;
    squares += error * error;
  }
  EXPECT_NEAR(sum / kPoints, 0.0, 4.0 / std::sqrt(kPoints));
  EXPECT_NEAR(squares / kPoints, 1.0, 4.0 * std::sqrt(2.0 / kPoints));
}

TEST(FrameFeatures, NoiseDependsOnSeedAndFrameOnly) {
  Recording recording;
  recording.frames.assign(2, {0.0, {}, {{0, {320, 240}, 2.0}, {1, {300, 240}, 2.0}}, {}});
  const auto depth = [&](std::size_t frame, std::size_t point, std::uint64_t seed) {
    SensorModel sensor;
    sensor.seed = seed;
    return features_of(recording, frame, kCamera, sensor).points[point].depth;
  };
  EXPECT_EQ(depth(1, 0, 5), depth(1, 0, 5));
  EXPECT_NE(depth(0, 0, 5), depth(1, 0, 5));
  EXPECT_NE(depth(0, 0, 5), depth(0, 1, 5));
  EXPECT_NE(depth(0, 0, 5), depth(0, 0, 6));
  const double alone = depth(0, 1, 5);
  recording.frames[0].points[0].pixel = {-5, 0};  // no longer in the image
  EXPECT_EQ(depth(0, 0, 5), alone);
}

TEST(FrameFeatures, ParallelLinesMakeOneVanishingDirection) {
  const Eigen::Vector3d direction = Eigen::Vector3d(1.0, 0.1, 0.3).normalized();
  const FrameFeatures frame = features_of(recording_of_lines(direction), 0, kCamera);
  ASSERT_EQ(frame.lines.size(), 5U);
  ASSERT_EQ(frame.directions.size(), 1U) << "a single line makes none";
  EXPECT_EQ(frame.directions[0].kind, features::DirectionKind::vanishing_direction);
  EXPECT_EQ(frame.directions[0].support, 4);
  EXPECT_LT(geometry::axial_angle(frame.directions[0].direction, direction), 1e-9);
  EXPECT_EQ(frame.lines[0].direction, 0);
  EXPECT_EQ(frame.lines[4].direction, -1);
  EXPECT_LT((frame.lines[1].start - Eigen::Vector3d(-0.9, 0.4, 2.5)).norm(), 1e-9);
}

/// Repeats the measurement with the noise that the model states; errors must agree with the covariances that it gives.
TEST(FrameFeatures, CovariancesOfDirectionsAndLinesAreTrue) {
  constexpr int kTrials = 400;
  const Eigen::Vector3d direction = Eigen::Vector3d(1.0, 0.1, 0.3).normalized();
  const Recording exact = recording_of_lines(direction);
  const FrameFeatures truth = features_of(exact, 0, kCamera);
  base::Random random(3);
  SensorModel sensor;
  sensor.max_direction_sigma = 0.2;
  double direction_chi2 = 0.0;
  double end_chi2 = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Recording noisy = exact;
    for (LineObservation& line : noisy.frames[0].lines) {
      for (Eigen::Vector2d* pixel : {&line.start_pixel, &line.end_pixel}) {
        *pixel += sensor.pixel_sigma * Eigen::Vector2d(random.normal(), random.normal());
      }
      for (double* depth : {&line.start_depth, &line.end_depth}) *depth += sensor.line_depth_sigma * random.normal();
    }
    const FrameFeatures frame = features_of(noisy, 0, kCamera, sensor);
    ASSERT_EQ(frame.directions.size(), 1U);
    const auto tangent = geometry::tangent_basis(direction);
    const Eigen::Vector2d error = tangent.transpose() * frame.directions[0].direction;
    const Eigen::Matrix2d covariance = tangent.transpose() * frame.directions[0].covariance * tangent;
    direction_chi2 += error.dot(covariance.inverse() * error) / 2.0 / kTrials;
    const Eigen::Vector3d off = frame.lines[0].end - truth.lines[0].end;
    end_chi2 += off.dot(frame.lines[0].end_covariance.inverse() * off) / 3.0 / kTrials;
  }
  EXPECT_NEAR(end_chi2, 1.0, 0.25);
  // The fit counts the turn of a segment as that of a line through many pixels, 1.5 times the variance of two ends.
  EXPECT_GT(direction_chi2, 0.4);
  EXPECT_LT(direction_chi2, 1.3);
}

TEST(FrameFeatures, DegenerateLinesDoNoHarm) {
  Recording recording;
  recording.frames.resize(1);
  recording.frames[0].lines = {{0, {100, 100}, {100, 100}, 2.0, 2.0},    // a point
                               {1, {100, 100}, {101, 100}, 2.0, 2.0},    // shorter than its noise
                               {2, {100, 100}, {200, 100}, -1.0, 2.0},   // no depth
                               {3, {320, 240}, {320.01, 240}, 1, 4.0}};  // along the ray
  for (std::int32_t id = 0; id < 4; ++id) recording.line_groups[id] = 0;
  const FrameFeatures frame = features_of(recording, 0, kCamera);
  ASSERT_EQ(frame.lines.size(), 4U);
  EXPECT_FALSE(frame.lines[2].has_depth);
  for (const auto& line : frame.lines) {
    EXPECT_TRUE(line.start.allFinite() && line.start_covariance.allFinite());
  }
  for (const auto& direction : frame.directions) {
    EXPECT_TRUE(direction.direction.allFinite() && direction.covariance.allFinite());
  }
}

}  // namespace
}  // namespace eg::observations
