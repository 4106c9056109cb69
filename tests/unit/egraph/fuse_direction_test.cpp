#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "common/egraph/graph_builder.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::egraph {
namespace {

using Eigen::Vector3d;
using test::tangential_covariance;

double largest_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues()[2]);
}

TEST(FuseDirection, CovarianceIsNeverOptimistic) {
  // Mean of chi²(2) over many fused directions: 2 if the covariance were exact, less because of the floor.
  base::Random random(3);
  double sum = 0.0;
  constexpr int kTrials = 1'000;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Vector3d truth = test::random_direction(random);
    DirectionLandmark landmark;
    landmark.direction = test::disturbed_direction(truth, 0.01, random);
    landmark.covariance = tangential_covariance(landmark.direction, 0.01);
    for (int view = 0; view < 8; ++view) {
      const double sigma = random.uniform(0.003, 0.02);
      const Vector3d seen = test::disturbed_direction(truth, sigma, random);
      fuse_direction(landmark, seen, tangential_covariance(seen, sigma), 0.0001);
    }
    const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(landmark.direction);
    const Eigen::Vector2d error = basis.transpose() * truth;
    sum += error.dot((basis.transpose() * landmark.covariance * basis).inverse() * error);
  }
  EXPECT_NEAR(sum / kTrials, 2.0, 0.25);
}

TEST(FuseDirection, TheMoreCertainViewCountsMore) {
  DirectionLandmark landmark;
  landmark.direction = Vector3d::UnitZ();
  landmark.covariance = tangential_covariance(landmark.direction, 0.02);
  const Vector3d seen = Vector3d(0.02, 0, 1).normalized();
  fuse_direction(landmark, seen, tangential_covariance(seen, 0.01), 0.0);
  // Weights 1 / 0.02² and 1 / 0.01²: four fifths of the way.
  EXPECT_NEAR(landmark.direction.x(), 0.016, 1e-5);
  EXPECT_NEAR(largest_sigma(landmark.covariance), 0.02 / std::sqrt(5.0), 1e-6);
}

}  // namespace
}  // namespace eg::egraph
