#include "common/eval/drift.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/base/random.hpp"
#include "common/geometry/so3.hpp"

namespace eg::eval {
namespace {

using geometry::StampedPose;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kFrames = 6001;  // ten minutes at 10 Hz

/// A straight way at 0.1 m/s; `error(t)` turns the camera about z (radians), the way is `scale` times too long.
std::vector<StampedPose> walk(const auto& error, double scale) {
  std::vector<StampedPose> trajectory;
  for (int i = 0; i < kFrames; ++i) {
    const double t = 0.1 * i;
    trajectory.push_back({t, {geometry::so3_exp({0, 0, error(t)}), {scale * 0.1 * t, 0, 0}}});
  }
  return trajectory;
}

const auto kExact = [](double) { return 0.0; };

TEST(Drift, GrowsWithAConstantRateOfTurn) {
  const auto drift = evaluate_drift(walk([](double t) { return 0.2 * kDegree * t / 60.0; }, 1.01), walk(kExact, 1.0));
  ASSERT_TRUE(drift.has_value()) << drift.error().message;
  EXPECT_NEAR(drift->rotation_slope_deg_per_min, 0.2, 1e-4);
  EXPECT_NEAR(drift->rotation_slope_sigma, 0.0, 1e-3);
  EXPECT_NEAR(drift->rotation_end_deg, 0.2 * 9.75, 1e-3);
  EXPECT_NEAR(drift->path_m, 60.0, 1e-9);
  EXPECT_NEAR(drift->end_error_m, 0.6, 1e-9);
  EXPECT_NEAR(drift->rotation_deg_per_m.mean, 0.2 / 6.0, 1e-3);
  EXPECT_EQ(drift->position_per_m.count, 51U);
}

TEST(Drift, PositionIsMeasuredPerMetre) {
  const auto drift = evaluate_drift(walk(kExact, 1.02), walk(kExact, 1.0));
  ASSERT_TRUE(drift.has_value());
  EXPECT_NEAR(drift->position_per_m.mean, 0.02, 1e-9);
  EXPECT_NEAR(drift->rotation_slope_deg_per_min, 0.0, 1e-9);
}

TEST(Drift, BoundedErrorHasNoSignificantSlope) {
  base::Random random(4);
  const auto drift =
      evaluate_drift(walk([&](double) { return 0.1 * kDegree * random.normal(); }, 1.0), walk(kExact, 1.0));
  ASSERT_TRUE(drift.has_value());
  EXPECT_LT(std::abs(drift->rotation_slope_deg_per_min), 3.0 * drift->rotation_slope_sigma);
  EXPECT_GT(drift->rotation_slope_sigma, 0.0);
}

TEST(Drift, ShortTrajectoriesAreRefusedOrHaveNoSegments) {
  auto short_one = walk(kExact, 1.0);
  short_one.resize(100);
  const auto drift = evaluate_drift(short_one, short_one);
  ASSERT_TRUE(drift.has_value());
  EXPECT_EQ(drift->position_per_m.count, 0U);
  short_one.resize(19);
  EXPECT_FALSE(evaluate_drift(short_one, short_one).has_value());
}

}  // namespace
}  // namespace eg::eval
