#include "services/viewer/plane_map.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace eg::services {
namespace {

/// A square of side 1 m around `centre`, on a plane with the normal.
MapPlane square(const Eigen::Vector3d& centre, const Eigen::Vector3d& normal, double support = 1000.0) {
  MapPlane plane;
  plane.plane.normal = normal;
  plane.plane.distance = -normal.dot(centre);
  plane.support = support;
  const Eigen::Vector3d u = normal.unitOrthogonal() / 2.0, v = normal.cross(u);
  plane.hull = {centre - u - v, centre + u - v, centre + u + v, centre - u + v};
  return plane;
}

double extent(const MapPlane& plane, const Eigen::Vector3d& axis) {
  double low = 1e9, high = -1e9;
  for (const Eigen::Vector3d& corner : plane.hull) {
    low = std::min(low, axis.dot(corner));
    high = std::max(high, axis.dot(corner));
  }
  return high - low;
}

const Eigen::Vector3d kX = Eigen::Vector3d::UnitX(), kZ = Eigen::Vector3d::UnitZ();

TEST(PlaneMap, JoinsPlanesThatLieInEachOtherAndTouch) {
  MapPlane wall = square({0.0, 0.0, 2.0}, -kZ, 3000.0);
  ASSERT_TRUE(join(wall, square({0.8, 0.0, 2.02}, -kZ, 1000.0)));
  EXPECT_NEAR(extent(wall, kX), 1.8, 1e-6);
  EXPECT_NEAR(wall.plane.distance, 2.005, 1e-9);  // the mean by support
  for (const Eigen::Vector3d& corner : wall.hull) EXPECT_NEAR(wall.plane.signed_distance(corner), 0.0, 1e-6);
}

TEST(PlaneMap, KeepsOtherPlanesApart) {
  const MapPlane wall = square({0.0, 0.0, 2.0}, -kZ);
  for (const MapPlane& other : {square({0.0, 0.0, 2.2}, -kZ),     // behind
                                square({0.0, 0.0, 2.0}, kZ),      // its back
                                square({3.0, 0.0, 2.0}, -kZ),     // beyond a gap
                                square({0.0, 0.0, 2.0}, -kX)}) {  // across
    MapPlane joined = wall;
    EXPECT_FALSE(join(joined, other));
    EXPECT_EQ(joined.hull.size(), 4u);
  }
}

TEST(PlaneMap, AWallSeenFromManyKeyframesIsOnePlaneAlsoAfterACorrection) {
  GraphView graph;
  PlaneMap map;
  features::PlaneFeature wall;
  wall.plane = {-kZ, 2.0};
  wall.support = 1000;
  wall.hull = square({0.0, 0.0, 2.0}, -kZ).hull;
  for (int id = 0; id < 20; ++id) {
    graph.add_keyframe({id}, {Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.05 * id, 0.0, 0.0)});
    map.add({id}, {wall});
  }
  Board board(1'000'000);
  EXPECT_TRUE(map.put(board, graph));
  ASSERT_EQ(map.planes().size(), 1u);
  EXPECT_NEAR(extent(map.planes()[0], kX), 1.95, 1e-6);

  graph.apply(tracking::PoseCorrection{0, 1, {{{0}, {Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.0, 0.0, 1.0)}}}});
  EXPECT_TRUE(map.put(board, graph));
  EXPECT_EQ(map.planes().size(), 2u);
}

}  // namespace
}  // namespace eg::services
