#include "common/features/direction_extractor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/random.hpp"
#include "common/geometry/so3.hpp"

namespace eg::features {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

geometry::CameraModel camera(double fy = 500.0) {
  return {"test", 640, 480, 500.0, fy, 319.5, 239.5, {}, 5000.0, 30.0};
}

struct Noise {
  double pixel_sigma = 0.2;
  double direction_sigma = 0.01;
};

/// The image and the measured direction of a segment in space, with the noise that their sigmas say.
MeasuredLine observe(const Vector3d& start, const Vector3d& end, bool has_depth, const Noise& noise,
                     const geometry::CameraModel& model, base::Random& random) {
  MeasuredLine line;
  const Segment exact{model.project(start), model.project(end)};
  const double shift = 0.5 * noise.pixel_sigma * random.normal();
  const double turn = std::sqrt(0.75) * noise.pixel_sigma * random.normal();
  line.segment = {exact.start + (shift - turn) * exact.normal(), exact.end + (shift + turn) * exact.normal(),
                  std::max(noise.pixel_sigma, 0.01)};
  line.feature.start_pixel = line.segment.start;
  line.feature.end_pixel = line.segment.end;
  line.feature.has_depth = has_depth;
  if (!has_depth) return line;
  const Vector3d normal = model.ray(line.segment.start).cross(model.ray(line.segment.end)).normalized();
  const Vector3d direction = (end - start).normalized();
  const Vector3d in_plane = (direction - normal * normal.dot(direction)).normalized();
  line.direction = geometry::so3_exp(noise.direction_sigma * random.normal() * normal) * in_plane;
  line.direction_sigma = std::max(noise.direction_sigma, 1e-4);
  return line;
}

/// A segment of the given direction somewhere in view, at least 40 pixels long.
MeasuredLine random_line(const Vector3d& direction, bool has_depth, const Noise& noise,
                         const geometry::CameraModel& model, base::Random& random) {
  while (true) {
    const Vector3d middle =
        model.unproject({random.uniform(40, 600), random.uniform(40, 440)}, random.uniform(1.0, 4.0));
    const Vector3d half = 0.5 * random.uniform(0.2, 1.0) * direction.normalized();
    const Vector3d start = middle - half;
    const Vector3d end = middle + half;
    if (start.z() < 0.3 || end.z() < 0.3) continue;
    if (!model.contains(model.project(start)) || !model.contains(model.project(end))) continue;
    if ((model.project(start) - model.project(end)).norm() < 40.0) continue;
    return observe(start, end, has_depth, noise, model, random);
  }
}

std::vector<MeasuredLine> parallel_lines(const Vector3d& direction, int count, bool has_depth, const Noise& noise,
                                         const geometry::CameraModel& model, base::Random& random) {
  std::vector<MeasuredLine> lines;
  for (int i = 0; i < count; ++i) lines.push_back(random_line(direction, has_depth, noise, model, random));
  return lines;
}

Vector3d random_direction(base::Random& random) {
  return Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

void append(std::vector<MeasuredLine>& lines, const std::vector<MeasuredLine>& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

int count_of(const std::vector<DirectionFeature>& directions, DirectionKind kind) {
  return static_cast<int>(
      std::count_if(directions.begin(), directions.end(), [&](const auto& d) { return d.kind == kind; }));
}

double nearest_angle(const std::vector<DirectionFeature>& directions, const Vector3d& truth) {
  double nearest = 10.0;
  for (const DirectionFeature& d : directions) nearest = std::min(nearest, geometry::axial_angle(d.direction, truth));
  return nearest;
}

/// Squared error in units of the covariance; expected 2.
double normalised_error(const DirectionFeature& feature, const Vector3d& truth) {
  const Vector3d signed_truth = truth.dot(feature.direction) < 0.0 ? Vector3d(-truth) : truth;
  const auto tangent = geometry::tangent_basis(feature.direction);
  const Vector2d error = tangent.transpose() * signed_truth;
  return error.dot((tangent.transpose() * feature.covariance * tangent).inverse() * error);
}

TEST(LineDirections, AreExactWithoutNoiseWhateverTheirAngles) {
  // Manhattan and not, with vanishing points in the image and at infinity, for both signs of fy.
  const std::vector<std::vector<Vector3d>> worlds{
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
      {{1, 0.2, 0.4}, {-0.1, 1, 0.3}, {-0.4, 0, 1}},
      {{1, 0, 0}, {1, 1, 0.2}, {0, 1, 0.5}, {-1, 0.4, 1}, {0.5, -1, 1}},
  };
  for (const double fy : {500.0, -480.0}) {
    for (const auto& world : worlds) {
      base::Random random(11);
      std::vector<MeasuredLine> lines;
      for (const Vector3d& direction : world) {
        append(lines, parallel_lines(direction, 12, true, {0.0, 0.0}, camera(fy), random));
      }
      const auto directions = extract_line_directions(lines, camera(fy));
      EXPECT_EQ(directions.size(), world.size());
      for (std::size_t i = 0; i < world.size(); ++i) {
        EXPECT_LT(nearest_angle(directions, world[i]), 1e-4);
        for (std::size_t k = 0; k < 12; ++k) {
          const auto group = static_cast<std::size_t>(lines[12 * i + k].feature.direction);
          ASSERT_LT(group, directions.size());
          EXPECT_LT(geometry::axial_angle(directions[group].direction, world[i]), 1e-3);
        }
      }
    }
  }
}

TEST(LineDirections, SegmentsWithoutDepthVoteToo) {
  base::Random random(2);
  std::vector<MeasuredLine> lines = parallel_lines({0.3, 0.1, 1}, 15, false, {}, camera(), random);
  append(lines, parallel_lines({1, 0, 0.1}, 15, false, {}, camera(), random));
  const auto directions = extract_line_directions(lines, camera());
  EXPECT_EQ(directions.size(), 2U);
  EXPECT_LT(nearest_angle(directions, {0.3, 0.1, 1}), 0.01);
  EXPECT_LT(nearest_angle(directions, {1, 0, 0.1}), 0.01);
}

TEST(LineDirections, DepthThrowsOutSegmentsThatOnlyMeetInTheImage) {
  // Ten parallel lines, and five others in space that point to the same vanishing point in the image.
  base::Random random(5);
  const geometry::CameraModel model = camera();
  const Vector3d direction(0.4, 0.05, 1.0);
  std::vector<MeasuredLine> lines = parallel_lines(direction, 10, true, {0.1, 0.005}, model, random);
  for (int i = 0; i < 5; ++i) {
    MeasuredLine line = random_line(direction, true, {0.1, 0.005}, model, random);
    const Vector3d normal = model.ray(line.segment.start).cross(model.ray(line.segment.end)).normalized();
    line.direction = geometry::so3_exp((0.3 + 0.1 * i) * normal) * line.direction;
    lines.push_back(line);
  }
  const auto directions = extract_line_directions(lines, model);
  ASSERT_EQ(count_of(directions, DirectionKind::vanishing_direction), 1);
  EXPECT_LT(geometry::axial_angle(directions[0].direction, direction), 0.005);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(lines[i].feature.direction, 0);
  for (std::size_t i = 10; i < 15; ++i) EXPECT_NE(lines[i].feature.direction, 0);
}

TEST(LineDirections, CovarianceIsConsistent) {
  DirectionExtractorOptions options;
  options.sigma_floor = 0.0;
  for (const bool has_depth : {true, false}) {
    double squares = 0.0;
    int count = 0;
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
      base::Random random(seed);
      const Vector3d truth = random_direction(random);
      auto lines = parallel_lines(truth, 10, has_depth, {0.3, 0.02}, camera(), random);
      const auto directions = extract_line_directions(lines, camera(), options);
      if (count_of(directions, DirectionKind::vanishing_direction) == 0) continue;
      squares += normalised_error(directions[0], truth);
      ++count;
    }
    EXPECT_GT(count, 130);
    EXPECT_GT(squares / count, 1.0) << "expected 2, within a factor of 2; depth " << has_depth;
    EXPECT_LT(squares / count, 4.0) << "expected 2, within a factor of 2; depth " << has_depth;
  }
}

TEST(LineDirections, FindsTrueGroupsAmongClutterWithoutInventingOthers) {
  int missed = 0;
  int invented = 0;
  std::vector<double> errors;
  constexpr int kTrials = 40;
  for (std::uint64_t seed = 0; seed < kTrials; ++seed) {
    base::Random random(seed);
    const Eigen::Matrix3d rotation = geometry::so3_exp(3.0 * random_direction(random));
    std::vector<MeasuredLine> lines;
    for (int axis = 0; axis < 3; ++axis) {
      append(lines, parallel_lines(rotation.col(axis), 8, true, {0.2, 0.01}, camera(), random));
    }
    for (int i = 0; i < 20; ++i) {
      lines.push_back(random_line(random_direction(random), random.index(4) != 0, {0.2, 0.01}, camera(), random));
    }
    const auto directions = extract_line_directions(lines, camera());
    for (int axis = 0; axis < 3; ++axis) {
      const double angle = nearest_angle(directions, rotation.col(axis));
      missed += angle > 0.035 ? 1 : 0;
      errors.push_back(angle);
    }
    for (const DirectionFeature& direction : directions) {
      const double off = (rotation.transpose() * direction.direction).cwiseAbs().maxCoeff();
      invented += direction.kind == DirectionKind::vanishing_direction && off < std::cos(0.035) ? 1 : 0;
    }
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.0087) << "median under half a degree";
  EXPECT_LE(missed, 0.05 * 3 * kTrials);
  EXPECT_LE(invented, 0.3 * kTrials);
}

TEST(LineDirections, SingleWellKnownLinesArePotential) {
  base::Random random(8);
  std::vector<MeasuredLine> lines{random_line({1, 0.2, 0.1}, true, {0.05, 0.003}, camera(), random),
                                  random_line({0, 1, 0.3}, true, {0.05, 0.2}, camera(), random),
                                  random_line({-1, 1, 0.5}, false, {0.05, 0.003}, camera(), random)};
  const auto directions = extract_line_directions(lines, camera());
  ASSERT_EQ(directions.size(), 1U) << "not the line of unsure direction, nor the one without depth";
  EXPECT_EQ(directions[0].kind, DirectionKind::potential_direction);
  EXPECT_EQ(directions[0].source, 0);
  EXPECT_LT(geometry::axial_angle(directions[0].direction, {1, 0.2, 0.1}), 0.02);
  EXPECT_EQ(lines[0].feature.direction, 0);
  EXPECT_EQ(lines[1].feature.direction, -1);
}

TEST(LineDirections, TakeAnyNumberOfLines) {
  std::vector<MeasuredLine> none;
  EXPECT_TRUE(extract_line_directions(none, camera()).empty());
  base::Random random(1);
  std::vector<MeasuredLine> same(7, random_line({1, 0, 0}, true, {}, camera(), random));
  EXPECT_LE(extract_line_directions(same, camera()).size(), 7U) << "one line, seven times";
  auto many = parallel_lines({0.2, 1, 0.1}, 500, true, {}, camera(), random);
  const auto directions = extract_line_directions(many, camera());
  ASSERT_EQ(count_of(directions, DirectionKind::vanishing_direction), 1);
  EXPECT_GT(directions[0].support, 450);
}

TEST(LineDirections, CovarianceIsTangential) {
  base::Random random(3);
  auto lines = parallel_lines({0.2, 0.3, 1}, 10, true, {}, camera(), random);
  for (const DirectionFeature& direction : extract_line_directions(lines, camera())) {
    EXPECT_NEAR(direction.direction.norm(), 1.0, 1e-12);
    EXPECT_LT((direction.covariance * direction.direction).norm(), 1e-12);
    EXPECT_LT((direction.covariance - direction.covariance.transpose()).norm(), 1e-15);
  }
}

TEST(PlaneDirections, CarryTheNormalAndItsTangentialCovariance) {
  PlaneFeature plane;
  plane.plane = {Vector3d(0, 0, -1), 2.0};
  plane.covariance.diagonal() << 1e-4, 4e-4, 9e-4, 1e-6;  // a covariance along the normal has no meaning
  plane.support = 1234;
  const auto directions = plane_directions({plane});
  ASSERT_EQ(directions.size(), 1U);
  EXPECT_EQ(directions[0].kind, DirectionKind::plane_normal);
  EXPECT_EQ(directions[0].source, 0);
  EXPECT_EQ(directions[0].support, 1234);
  EXPECT_NEAR(directions[0].covariance(0, 0), 1e-4, 1e-12);
  EXPECT_NEAR(directions[0].covariance(1, 1), 4e-4, 1e-12);
  EXPECT_NEAR(directions[0].covariance(2, 2), 0.0, 1e-12);
}

TEST(LineDirections, RefuseOptionsOutOfRange) {
  EXPECT_TRUE(validate(DirectionExtractorOptions{}));
  DirectionExtractorOptions options;
  options.hypotheses = kMaxHypotheses + 1;
  EXPECT_FALSE(validate(options));
  options = {};
  options.group.min_depth_lines = 1;
  EXPECT_FALSE(validate(options));
}

TEST(AddWarp, MakesDirectionsLessCertainAcrossThemselvesOnly) {
  DirectionExtractorOptions options;
  options.warp_sigma = 0.02;
  const Vector3d direction = Vector3d(1, 2, -2) / 3.0;
  std::vector<DirectionFeature> directions(1);
  directions[0].direction = direction;
  add_warp(0.0, options, directions);
  EXPECT_TRUE(directions[0].covariance.isZero());
  add_warp(0.5, options, directions);
  EXPECT_NEAR((directions[0].covariance * direction).norm(), 0.0, 1e-12);
  EXPECT_NEAR(directions[0].covariance.trace(), 2.0 * 0.01 * 0.01, 1e-12);
}

}  // namespace
}  // namespace eg::features
