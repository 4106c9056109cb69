#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "common/mapping/mesh_parts.hpp"
#include "common/mapping/tsdf_map.hpp"
#include "tests/unit/mapping/analytic_scene.hpp"
#include "tests/unit/mapping/mesh_checks.hpp"

namespace eg::mapping {
namespace {

TsdfMap map_of_room(int share, int shares) {
  TsdfOptions options;
  options.voxel_size = 0.02;  // the room is then larger than a share's cubes
  options.share = share;
  options.shares = shares;
  TsdfMap map(options);
  const geometry::CameraModel camera = square_camera(200, 75.0);
  for (const geometry::Pose& pose : views_all_round({0.1, 0.05, 0.2})) {
    EXPECT_TRUE(map.integrate(empty_room().render(camera, pose), pose));
  }
  return map;
}

using Corner = std::array<float, 9>;  // position, normal, colour
using Triangle = std::array<Corner, 3>;

/// What a mesh is, whatever the order of its vertices and triangles.
std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (const auto& indices : mesh.triangles) {
    Triangle& triangle = triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t v = indices[i];
      for (int axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<std::size_t>(axis);
        triangle[i][at] = mesh.vertices[v][axis];
        triangle[i][3 + at] = mesh.normals[v][axis];
        triangle[i][6 + at] = mesh.colours[v][at];
      }
    }
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

TEST(TileShareTest, SharesMakeUpTheMeshOfOneMapWithoutSeams) {
  const TsdfMap whole = map_of_room(0, 1);
  const Mesh mesh = whole.extract_mesh().value();
  for (const int shares : {2, 3}) {
    std::vector<Mesh> parts;
    std::int64_t leaves = 0;
    for (int share = 0; share < shares; ++share) {
      const TsdfMap part = map_of_room(share, shares);
      parts.push_back(part.extract_mesh().value());
      EXPECT_FALSE(parts.back().triangles.empty());
      EXPECT_LT(part.leaf_count(), whole.leaf_count());
      leaves += part.leaf_count();
    }
    const Mesh joined = join_meshes(parts);
    EXPECT_EQ(joined.vertices.size(), mesh.vertices.size());
    EXPECT_TRUE(triangles_of(joined) == triangles_of(mesh)) << shares << " shares";
    EXPECT_EQ(check_edges(joined).open, check_edges(mesh).open);
    EXPECT_LT(static_cast<double>(leaves), 1.6 * static_cast<double>(whole.leaf_count()));
  }
}

TEST(TileShareTest, OnlyOwnTilesAreAnnounced) {
  std::vector<std::array<int, 3>> announced;
  for (int share = 0; share < 2; ++share) {
    TsdfMap map = map_of_room(share, 2);
    for (const Eigen::Vector3i& tile : map.take_changed_tiles()) announced.push_back({tile.x(), tile.y(), tile.z()});
  }
  std::sort(announced.begin(), announced.end());
  EXPECT_EQ(std::adjacent_find(announced.begin(), announced.end()), announced.end());
  EXPECT_EQ(announced.size(), map_of_room(0, 1).take_changed_tiles().size());
}

TEST(TileShareTest, RefusesAShareThatIsNone) {
  TsdfOptions options;
  options.share = 2;
  options.shares = 2;
  EXPECT_FALSE(validate(options));
}

}  // namespace
}  // namespace eg::mapping
