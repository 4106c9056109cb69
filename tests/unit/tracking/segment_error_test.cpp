#include "common/tracking/segment_error.hpp"

#include <gtest/gtest.h>

#include "tests/support/random_geometry.hpp"

namespace eg::tracking {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

TEST(SegmentError, PlacesCountFromStartToEnd) {
  const Vector2d start(10, 20);
  const Vector2d end(40, 60);
  EXPECT_DOUBLE_EQ(place_along(start, end, start), 0.0);
  EXPECT_DOUBLE_EQ(place_along(start, end, end), 1.0);
  EXPECT_DOUBLE_EQ(place_along(start, end, Vector2d(2.0 * end - start)), 2.0);
  EXPECT_NEAR(place_along(start, end, Vector2d(start + Vector2d(-4, 3))), 0.0, 1e-12) << "beside the start";
}

TEST(SegmentError, CovarianceIsThatOfLinesThroughDisturbedPoints) {
  base::Random random(7);
  constexpr int kTrials = 40'000;
  for (const Vector2d& places : {Vector2d(0, 1), Vector2d(0.2, 0.9), Vector2d(-3, 0.5), Vector2d(4, 6)}) {
    const double start_sigma = random.uniform(0.5, 2.0);
    const double end_sigma = random.uniform(0.5, 2.0);
    Matrix2d sampled = Matrix2d::Zero();
    for (int trial = 0; trial < kTrials; ++trial) {
      const double start = start_sigma * random.normal();
      const double end = end_sigma * random.normal();
      const Vector2d heights = Vector2d::Constant(start) + places * (end - start);
      sampled += heights * heights.transpose() / kTrials;
    }
    const Matrix2d expected = covariance_along(start_sigma * start_sigma, end_sigma * end_sigma, places);
    EXPECT_LT((sampled - expected).norm(), 0.05 * expected.norm()) << "places " << places.transpose();
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(variance_along(start_sigma * start_sigma, end_sigma * end_sigma, places[i]), expected(i, i), 1e-9);
    }
  }
}

TEST(SegmentError, WhitenedErrorsHaveUnitCovariance) {
  base::Random random(8);
  for (int trial = 0; trial < 100; ++trial) {
    const Matrix2d covariance = test::random_covariance(random, 0.01, 10.0);
    const Matrix2d w = whitener(covariance);
    EXPECT_LT((w * covariance * w.transpose() - Matrix2d::Identity()).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace eg::tracking
