#include "common/egraph/direction_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/random_geometry.hpp"

namespace eg::egraph {
namespace {

using Eigen::Vector3d;
using test::kDegree;

TEST(DirectionIndex, FindsAllWithinTheAngleWhateverTheSign) {
  base::Random random(1);
  DirectionIndex index;
  std::vector<Vector3d> directions = {Vector3d::UnitX(), Vector3d::UnitY(), -Vector3d::UnitZ()};
  while (directions.size() < 500) directions.push_back(test::random_direction(random));
  for (std::size_t i = 0; i < directions.size(); ++i) index.insert(LandmarkId{static_cast<int>(i)}, directions[i]);

  for (int trial = 0; trial < 300; ++trial) {
    const Vector3d asked = trial < 3 ? Vector3d::Unit(trial) : test::random_direction(random);
    const double angle = (trial % 4 + 1) * 4.0 * kDegree;
    const std::vector<LandmarkId> found = index.near(asked, angle);
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
    EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
    EXPECT_LT(found.size(), directions.size() / 2) << "it looks at a part only";
    for (std::size_t i = 0; i < directions.size(); ++i) {
      if (geometry::axial_angle(asked, directions[i]) > angle) continue;
      EXPECT_TRUE(std::binary_search(found.begin(), found.end(), LandmarkId{static_cast<int>(i)}));
    }
  }
}

TEST(DirectionIndex, ForgetsWhatIsErased) {
  DirectionIndex index;
  index.insert(LandmarkId{3}, Vector3d::UnitX());
  index.insert(LandmarkId{5}, Vector3d::UnitX());
  index.erase(LandmarkId{3}, Vector3d::UnitX());
  index.erase(LandmarkId{9}, Vector3d::UnitY());
  EXPECT_EQ(index.near(-Vector3d::UnitX(), 0.01), std::vector{LandmarkId{5}});
}

}  // namespace
}  // namespace eg::egraph
