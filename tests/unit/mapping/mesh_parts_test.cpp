#include "common/mapping/mesh_parts.hpp"

#include <gtest/gtest.h>

#include "common/mapping/tsdf_map.hpp"
#include "tests/unit/mapping/analytic_scene.hpp"
#include "tests/unit/mapping/mesh_checks.hpp"

namespace eg::mapping {
namespace {

TEST(MeshPartsTest, KeepsEveryTriangleWithinTheLimit) {
  TsdfMap map;
  ASSERT_TRUE(map.integrate(empty_room().render(square_camera(100, 80.0), {}), {}));
  const Mesh mesh = map.extract_mesh().value();
  constexpr std::size_t kLimit = 20'000;
  const std::vector<Mesh> parts = split_mesh(mesh, kLimit);
  EXPECT_GT(parts.size(), 3U);
  std::size_t next = 0;
  for (const Mesh& part : parts) {
    EXPECT_LE(kVertexBytes * part.vertices.size() + kTriangleBytes * part.triangles.size(), kLimit);
    EXPECT_EQ(part.normals.size(), part.vertices.size());
    EXPECT_EQ(part.colours.size(), part.vertices.size());
    for (const auto& triangle : part.triangles) {
      ASSERT_LT(next, mesh.triangles.size());
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(part.vertices[triangle[i]], mesh.vertices[mesh.triangles[next][i]]);
        EXPECT_EQ(part.normals[triangle[i]], mesh.normals[mesh.triangles[next][i]]);
        EXPECT_EQ(part.colours[triangle[i]], mesh.colours[mesh.triangles[next][i]]);
      }
      ++next;
    }
  }
  EXPECT_EQ(next, mesh.triangles.size());
}

TEST(MeshPartsTest, AMeshThatFitsIsOnePart) {
  TsdfMap map;
  ASSERT_TRUE(map.integrate(empty_room().render(square_camera(30, 80.0), {}), {}));
  EXPECT_EQ(split_mesh(map.extract_mesh().value(), 10'000'000).size(), 1U);
}

TEST(MeshPartsTest, AnEmptyMeshIsOneEmptyPart) {
  const std::vector<Mesh> parts = split_mesh({}, 1000);
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_TRUE(parts[0].vertices.empty());
}

}  // namespace
}  // namespace eg::mapping
