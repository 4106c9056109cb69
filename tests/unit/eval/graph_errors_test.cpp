#include "common/eval/graph_errors.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "common/base/random.hpp"
#include "common/eval/frustum.hpp"
#include "common/geometry/so3.hpp"

namespace eg::eval {
namespace {

using geometry::Pose;
using geometry::StampedPose;

constexpr double kDegree = std::numbers::pi / 180.0;

/// A field of view of 60 degrees from side to side.
geometry::CameraModel camera() {
  const double focal = 0.5 * 599 / std::tan(30 * kDegree);
  return {"test", 600, 400, focal, focal, 299.5, 199.5, {}, 1000, 30};
}

Pose turned(double degrees_about_y, const Eigen::Vector3d& position = Eigen::Vector3d::Zero()) {
  return {geometry::so3_exp({0, degrees_about_y * kDegree, 0}), position};
}

bool overlap(const Pose& a, const Pose& b, const geometry::CameraModel& model = camera()) {
  const Frustum first(model, a, 0.3, 8.0), second(model, b, 0.3, 8.0);
  EXPECT_EQ(first.intersects(second), second.intersects(first));
  return first.intersects(second);
}

TEST(Frustum, TurningInPlaceBeyondTheFieldOfViewEndsTheOverlap) {
  EXPECT_TRUE(overlap(turned(0), turned(0)));
  EXPECT_TRUE(overlap(turned(0), turned(59)));
  EXPECT_FALSE(overlap(turned(0), turned(61)));
  EXPECT_FALSE(overlap(turned(0), turned(-90)));
  EXPECT_FALSE(overlap(turned(0), turned(180)));
}

TEST(Frustum, DistanceMatters) {
  EXPECT_TRUE(overlap(turned(0), turned(180, {0, 0, 10})));     // facing each other
  EXPECT_FALSE(overlap(turned(0), turned(180, {0, 0, 16.1})));  // too far apart to measure the same
  EXPECT_FALSE(overlap(turned(0), turned(0, {0, 0, 7.8})));
  EXPECT_TRUE(overlap(turned(0), turned(0, {0, 0, 7.6})));
  const double width = 2 * 8.0 * std::tan(30 * kDegree);
  EXPECT_TRUE(overlap(turned(0), turned(0, {width - 0.01, 0, 0})));
  EXPECT_FALSE(overlap(turned(0), turned(0, {width + 0.01, 0, 0})));
}

TEST(Frustum, ANegativeFocalLengthSeesTheSameSpace) {
  geometry::CameraModel flipped = camera();
  flipped.fy = -flipped.fy;
  base::Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Pose pose{geometry::so3_exp(2.0 * Eigen::Vector3d(random.normal(), random.normal(), random.normal())),
                    4.0 * Eigen::Vector3d(random.normal(), random.normal(), random.normal())};
    EXPECT_EQ(overlap({}, pose), overlap({}, pose, flipped));
  }
}

TEST(Frustum, NeverMissesACommonPoint) {
  base::Random random(5);
  const auto inside = [&](const Pose& world_from_camera, const Eigen::Vector3d& point) {
    const Eigen::Vector3d p = world_from_camera.inverse() * point;
    return p.z() >= 0.3 && p.z() <= 8.0 && camera().contains(camera().project(p));
  };
  int overlapping = 0;
  for (int round = 0; round < 300; ++round) {
    const Pose pose{geometry::so3_exp(2.0 * Eigen::Vector3d(random.normal(), random.normal(), random.normal())),
                    5.0 * Eigen::Vector3d(random.normal(), random.normal(), random.normal())};
    bool common = false;
    for (int i = 0; i < 300 && !common; ++i) {
      const Eigen::Vector2d pixel(random.uniform(0, 599), random.uniform(0, 399));
      common = inside(pose, camera().unproject(pixel, random.uniform(0.3, 8.0)));
    }
    if (common) {
      EXPECT_TRUE(overlap({}, pose));
    }
    overlapping += common ? 1 : 0;
  }
  EXPECT_GT(overlapping, 30);
}

class GraphErrorsTest : public testing::Test {
 protected:
  GraphErrorsTest() {
    options_.camera = camera();
    for (int i = 0; i < 4; ++i) reference_.push_back({1.0 * i, turned(50.0 * i)});
    keyframes_ = reference_;
  }
  GraphErrorOptions options_;
  std::vector<StampedPose> reference_, keyframes_;
  const std::vector<GraphEdge> edges_ = {{0, 1}, {1, 2}, {0, 2}, {0, 3}};
};

TEST_F(GraphErrorsTest, TheWorldFrameDoesNotMatter) {
  for (StampedPose& keyframe : keyframes_) {
    keyframe.world_from_camera = Pose{geometry::so3_exp({1, 2, 3}), {4, 5, 6}} * keyframe.world_from_camera;
  }
  const auto errors = evaluate_graph(keyframes_, edges_, reference_, options_);
  ASSERT_TRUE(errors.has_value());
  EXPECT_EQ(errors->all_deg.count, 4U);
  EXPECT_LT(errors->all_deg.max, 1e-6);
}

TEST_F(GraphErrorsTest, ErrorsAreSplitByOverlap) {
  Eigen::Matrix3d& rotation = keyframes_[2].world_from_camera.rotation;
  rotation = rotation * geometry::so3_exp({0, 0, 2 * kDegree});
  const auto errors = evaluate_graph(keyframes_, edges_, reference_, options_);
  ASSERT_TRUE(errors.has_value());
  EXPECT_EQ(errors->overlapping_deg.count, 2U);
  EXPECT_NEAR(errors->overlapping_deg.mean, 1.0, 1e-9);
  EXPECT_EQ(errors->non_overlapping_deg.count, 2U);
  EXPECT_NEAR(errors->non_overlapping_deg.max, 2.0, 1e-9);
  EXPECT_NEAR(errors->all_deg.mean, 1.0, 1e-9);
}

TEST_F(GraphErrorsTest, KeyframesWithoutReferenceAreCounted) {
  reference_.pop_back();
  const auto errors = evaluate_graph(keyframes_, edges_, reference_, options_);
  ASSERT_TRUE(errors.has_value());
  EXPECT_EQ(errors->edges, 4U);
  EXPECT_EQ(errors->edges_without_reference, 1U);
  EXPECT_EQ(errors->all_deg.count, 3U);
  EXPECT_EQ(evaluate_graph(keyframes_, edges_, {}, options_).error().message,
            "none of the 4 keyframes has a reference pose at its time");
  EXPECT_EQ(evaluate_graph(keyframes_, {}, reference_, options_)->all_deg.count, 0U);
}

}  // namespace
}  // namespace eg::eval
