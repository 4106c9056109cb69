#include "common/features/plane_moments.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"

namespace eg::features {
namespace {

TEST(PlaneMoments, FitIsExactAndSumsOfPartsEqualTheWhole) {
  const InverseDepthPlane truth(0.2, -0.1, 0.5);
  base::Random random(1);
  PlaneMoments left, right, whole;
  for (int i = 0; i < 200; ++i) {
    const double x = random.uniform(0.4, 0.42);
    const double y = random.uniform(-0.3, -0.28);
    const double w = truth.dot(Eigen::Vector3d(x, y, 1));
    (i % 3 == 0 ? left : right).add(x, y, w);
    whole.add(x, y, w);
  }
  for (const PlaneMoments& moments : {whole, left + right}) {
    const PlaneFit fit = fit_plane(moments);
    ASSERT_TRUE(fit.valid);
    EXPECT_LT((fit.plane - truth).norm(), 1e-8);
    EXPECT_LT(fit.mean_squared_error, 1e-15);
  }
}

TEST(PlaneMoments, ErrorUnderAPlaneIsTheMeanSquareOfResiduals) {
  base::Random random(2);
  const InverseDepthPlane plane(0.1, 0.3, 0.4);
  PlaneMoments moments;
  double sum = 0;
  constexpr int kPixels = 50;
  for (int i = 0; i < kPixels; ++i) {
    const Eigen::Vector3d ray(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 1.0);
    const double w = random.uniform(0.3, 0.6);
    moments.add(ray.x(), ray.y(), w);
    sum += (w - plane.dot(ray)) * (w - plane.dot(ray));
  }
  EXPECT_NEAR(moments.mean_squared_error(plane), sum / kPixels, 1e-12);
  moments.scale(4.0);
  EXPECT_NEAR(moments.mean_squared_error(plane), 4.0 * sum / kPixels, 1e-12);
  // At the least-squares plane the score vanishes, and no other plane has a smaller error.
  const PlaneFit fit = fit_plane(moments);
  ASSERT_TRUE(fit.valid);
  EXPECT_LT(moments.score(fit.plane).norm(), 1e-9);
  EXPECT_NEAR(moments.mean_squared_error(fit.plane), fit.mean_squared_error, 1e-12);
  EXPECT_LE(fit.mean_squared_error, moments.mean_squared_error(plane));
}

TEST(PlaneMoments, PixelsThatDetermineNoPlaneAreInvalid) {
  PlaneMoments moments;
  EXPECT_FALSE(fit_plane(moments).valid);
  for (int i = 0; i < 10; ++i) moments.add(0.01 * i, 0.2, 0.5);  // one row
  EXPECT_FALSE(fit_plane(moments).valid);
  moments = {};
  for (int i = 0; i < 10; ++i) moments.add(0.01 * i, 0.02 * i, 0.5);  // one diagonal
  EXPECT_FALSE(fit_plane(moments).valid);
}

}  // namespace
}  // namespace eg::features
