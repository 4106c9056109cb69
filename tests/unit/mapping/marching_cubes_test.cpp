#include "common/mapping/marching_cubes.hpp"

#include <gtest/gtest.h>

#include <set>

#include "common/base/random.hpp"
#include "common/mapping/tile_mesher.hpp"
#include "tests/unit/mapping/mesh_checks.hpp"

namespace eg::mapping {
namespace {

TEST(MarchingCubesTest, CutsExactlyTheEdgesWhoseEndsDiffer) {
  for (int negative = 0; negative < 256; ++negative) {
    std::set<int> used;
    for (const auto& triangle : cube_triangles(static_cast<std::uint8_t>(negative))) {
      used.insert(triangle.begin(), triangle.end());
    }
    for (int e = 0; e < kCubeEdges; ++e) {
      const CubeEdge& edge = cube_edges()[static_cast<std::size_t>(e)];
      const bool is_cut = ((negative >> edge.low ^ negative >> edge.high) & 1) != 0;
      EXPECT_EQ(used.contains(e), is_cut) << "corners " << negative << ", edge " << e;
    }
  }
}

TEST(MarchingCubesTest, HasAtMostFiveTrianglesAndNoneForAWholeCell) {
  EXPECT_TRUE(cube_triangles(0).empty());
  EXPECT_TRUE(cube_triangles(255).empty());
  for (int negative = 1; negative < 255; ++negative) {
    const std::size_t count = cube_triangles(static_cast<std::uint8_t>(negative)).size();
    EXPECT_GE(count, 1U);
    EXPECT_LE(count, 5U);
  }
}

TEST(MarchingCubesTest, TurnsTheTriangleOfOneNegativeCornerToTheOthers) {
  const CubeTriangles& triangles = cube_triangles(1);
  ASSERT_EQ(triangles.size(), 1U);
  std::array<Eigen::Vector3d, 3> points;
  for (std::size_t i = 0; i < 3; ++i) points[i] = 0.5 * Eigen::Vector3d::Unit(cube_edges()[triangles[0][i]].axis);
  EXPECT_GT((points[1] - points[0]).cross(points[2] - points[0]).dot(Eigen::Vector3d::Ones()), 0.0);
}

/// Every combination of neighbouring cells turns up in noise; whatever they are, the surface must close.
TEST(MarchingCubesTest, ClosesTheSurfaceOfNoise) {
  base::Random random(3);
  for (int trial = 0; trial < 5; ++trial) {
    TileBlock block(Eigen::Vector3i::Zero());
    const int size = 14;
    for (int x = 1; x <= size; ++x) {
      for (int y = 1; y <= size; ++y) {
        for (int z = 1; z <= size; ++z) {
          const bool is_rim = std::min({x, y, z}) == 1 || std::max({x, y, z}) == size;
          const double value = is_rim ? random.uniform(0.1, 1.0) : random.uniform(-1.0, 1.0);
          block.distance[static_cast<std::size_t>(TileBlock::index(x, y, z))] = static_cast<float>(value);
        }
      }
    }
    const Mesh mesh = mesh_tile(block, 1.0, 100.0).mesh;
    const EdgeReport edges = check_edges(mesh);
    EXPECT_GT(mesh.triangles.size(), 1000U);
    EXPECT_EQ(edges.open, 0);
    EXPECT_EQ(edges.overused, 0);
    EXPECT_GT(smallest_area(mesh), 0.0F);
  }
}

TEST(MarchingCubesTest, MovesVerticesOffCornersWhereTheFieldIsZero) {
  TileBlock block(Eigen::Vector3i::Zero());
  for (int x = 4; x <= 8; ++x) {
    for (int y = 4; y <= 8; ++y) {
      for (int z = 4; z <= 8; ++z) {
        block.distance[static_cast<std::size_t>(TileBlock::index(x, y, z))] = static_cast<float>(z - 6);
      }
    }
  }
  const Mesh mesh = mesh_tile(block, 0.02, 1e3).mesh;
  EXPECT_EQ(mesh.triangles.size(), 2U * 4 * 4);
  EXPECT_GT(smallest_area(mesh), 1e-5F);
  EXPECT_EQ(check_edges(mesh).overused, 0);
}

}  // namespace
}  // namespace eg::mapping
