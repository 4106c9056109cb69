#include <gtest/gtest.h>

#include <sstream>

#include "common/mapping/tsdf_map.hpp"
#include "tests/unit/mapping/analytic_scene.hpp"
#include "tests/unit/mapping/mesh_checks.hpp"

namespace eg::mapping {
namespace {

TsdfMap small_map() {
  TsdfMap map;
  const AnalyticScene scene{{{{0, 0, 1.0}, 0.2}}, {}};
  EXPECT_TRUE(map.integrate(scene.render(square_camera(100, 200.0), {}), {}));
  return map;
}

std::string written(const TsdfMap& map) {
  std::ostringstream out;
  EXPECT_TRUE(map.write_vdb(out));
  return out.str();
}

base::Result<TsdfMap> read(const std::string& bytes, const TsdfOptions& options = {}) {
  std::istringstream in(bytes);
  return TsdfMap::read_vdb(in, options);
}

TEST(VdbFormatTest, ReadsBackWhatWasWritten) {
  const TsdfMap map = small_map();
  auto again = read(written(map));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->leaf_count(), map.leaf_count());
  EXPECT_FALSE(again->take_changed_tiles().empty());
  EXPECT_TRUE(is_same(again->extract_mesh().value(), map.extract_mesh().value()));
}

TEST(VdbFormatTest, AMapThatWasReadCanBeContinued) {
  auto map = read(written(small_map()));
  ASSERT_TRUE(map);
  const AnalyticScene scene{{{{0, 0, 1.0}, 0.2}}, {}};
  ASSERT_TRUE(map->deintegrate(scene.render(square_camera(100, 200.0), {}), {}));
  EXPECT_EQ(map->leaf_count(), 0);
}

TEST(VdbFormatTest, KeepsAnEmptyMap) {
  const auto map = read(written(TsdfMap()));
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->leaf_count(), 0);
}

TEST(VdbFormatTest, RefusesAnotherVoxelSize) {
  TsdfOptions options;
  options.voxel_size = 0.01;
  const auto map = read(written(small_map()), options);
  ASSERT_FALSE(map);
  EXPECT_NE(map.error().message.find("voxels"), std::string::npos) << map.error().message;
}

TEST(VdbFormatTest, RefusesWhatIsNoVdbFile) {
  const std::string whole = written(small_map());
  EXPECT_FALSE(read(""));
  EXPECT_FALSE(read("ply\nformat ascii 1.0\n"));
  for (const double share : {0.01, 0.1, 0.5, 0.9}) {
    EXPECT_FALSE(read(whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))))) << share;
  }
}

}  // namespace
}  // namespace eg::mapping
