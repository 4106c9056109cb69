#include <gtest/gtest.h>

#include "common/mapping/tsdf_map.hpp"
#include "tests/unit/mapping/analytic_scene.hpp"
#include "tests/unit/mapping/mesh_checks.hpp"

namespace eg::mapping {
namespace {

TsdfOptions coarse() {
  TsdfOptions options;
  options.voxel_size = 0.04;
  return options;
}

TsdfMap map_of_room(std::size_t views) {
  TsdfMap map(coarse());
  const std::vector<geometry::Pose> poses = views_all_round({0.1, 0.05, 0.2});
  for (std::size_t i = 0; i < views; ++i) {
    EXPECT_TRUE(map.integrate(empty_room().render(square_camera(160, 60.0), poses[i]), poses[i]));
  }
  return map;
}

TsdfMap copy(const TsdfMap& map) {
  TsdfMap result(map.options());
  for (const Eigen::Vector3i& tile : map.tiles()) EXPECT_TRUE(result.unpack_tile(tile, map.pack_tile(tile).value()));
  return result;
}

TEST(TilePageTest, ACopiedMapGoesOnLikeTheOriginal) {
  TsdfMap copied = copy(map_of_room(3));
  EXPECT_TRUE(is_same(copied.extract_mesh().value(), map_of_room(3).extract_mesh().value()));
  const std::vector<geometry::Pose> poses = views_all_round({0.1, 0.05, 0.2});
  for (std::size_t i = 3; i < 6; ++i) {
    ASSERT_TRUE(copied.integrate(empty_room().render(square_camera(160, 60.0), poses[i]), poses[i]));
  }
  EXPECT_TRUE(is_same(copied.extract_mesh().value(), map_of_room(6).extract_mesh().value()));
}

TEST(TilePageTest, ACopiedMapHasItsWholeMeshToSend) {
  TsdfMap map = map_of_room(3);
  TsdfMap copied = copy(map);
  const std::vector<Eigen::Vector3i> changed = copied.take_changed_tiles();
  for (const Eigen::Vector3i& tile : map.take_changed_tiles()) {
    if (map.extract_tile(tile).value().triangles.empty()) continue;
    EXPECT_NE(std::find(changed.begin(), changed.end(), tile), changed.end());
  }
}

TEST(TilePageTest, RefusesWhatIsNoTile) {
  const TsdfMap map = map_of_room(1);
  const Eigen::Vector3i tile = map.tiles().front();
  const std::string sound = map.pack_tile(tile).value();
  for (std::size_t at = 0; at < sound.size(); at += 1 + sound.size() / 100) {
    TsdfMap empty(coarse());
    EXPECT_FALSE(empty.unpack_tile(tile, std::string_view(sound).substr(0, at))) << at;
    EXPECT_EQ(empty.leaf_count(), 0);
  }
  TsdfMap full(coarse());
  EXPECT_TRUE(full.unpack_tile(tile, sound));
  EXPECT_FALSE(full.unpack_tile(tile, sound));
}

}  // namespace
}  // namespace eg::mapping
