#include <gtest/gtest.h>

#include <array>
#include <map>
#include <sstream>

#include "common/mapping/tsdf_map.hpp"
#include "tests/unit/mapping/analytic_scene.hpp"
#include "tests/unit/mapping/mesh_checks.hpp"

namespace eg::mapping {
namespace {

/// A disk, which may be full or lose what it has.
class FakeDisk : public TileStore {
 public:
  base::Status put(const Eigen::Vector3i& tile, std::string_view bytes) override {
    if (is_full) return base::fail("the disk is full");
    files[{tile.x(), tile.y(), tile.z()}] = bytes;
    ++writes;
    return {};
  }
  base::Result<std::string> get(const Eigen::Vector3i& tile) override {
    if (is_damaged) return base::fail("the disk is damaged");
    ++reads;
    return files.at({tile.x(), tile.y(), tile.z()});
  }

  std::map<std::array<int, 3>, std::string> files;
  int writes = 0;
  int reads = 0;
  bool is_full = false;
  bool is_damaged = false;
};

// In OpenVDB's file format, version 224.
constexpr std::size_t kIdentityAt = 21;
constexpr std::size_t kIdentitySize = 36;
constexpr std::int64_t kBudget = 1'500'000;  // bytes; the map takes about four times as many

class TilePagerTest : public ::testing::Test {
 protected:
  TilePagerTest() { limited_.limit_memory(kBudget, disk_); }

  base::Result<IntegrationSummary> integrate(TsdfMap& map, std::size_t view) {
    auto summary = map.integrate(empty_room().render(camera_, poses_[view]), poses_[view]);
    return summary;
  }
  void integrate_all() {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      ASSERT_TRUE(integrate(whole_, i));
      const auto summary = integrate(limited_, i);
      ASSERT_TRUE(summary) << summary.error().message;
      const auto kept = limited_.keep_budget();
      ASSERT_TRUE(kept) << kept.error().message;
    }
  }

  static TsdfOptions options() {
    TsdfOptions options;
    options.voxel_size = 0.02;
    return options;
  }
  /// Without the random identity that OpenVDB writes into the header.
  static std::string vdb_of(const TsdfMap& map) {
    std::ostringstream out;
    const auto written = map.write_vdb(out);
    EXPECT_TRUE(written) << written.error().message;
    return out.str().erase(kIdentityAt, kIdentitySize);
  }

  geometry::CameraModel camera_ = square_camera(120, 50.0);
  std::vector<geometry::Pose> poses_ = views_all_round({0.1, 0.05, 0.2});
  std::shared_ptr<FakeDisk> disk_ = std::make_shared<FakeDisk>();
  TsdfMap whole_{options()};
  TsdfMap limited_{options()};
};

TEST_F(TilePagerTest, NothingThatTheMapGivesDependsOnTheBudget) {
  integrate_all();
  ASSERT_GT(whole_.memory_bytes(), 3 * kBudget);
  EXPECT_LT(3 * limited_.leaf_count(), whole_.leaf_count());
  EXPECT_GT(disk_->reads, 0);
  EXPECT_EQ(limited_.take_changed_tiles(), whole_.take_changed_tiles());
  EXPECT_TRUE(is_same(limited_.extract_mesh().value(), whole_.extract_mesh().value()));
  EXPECT_TRUE(vdb_of(limited_) == vdb_of(whole_));
  ASSERT_EQ(limited_.tiles(), whole_.tiles());
  for (std::size_t i = 0; i < whole_.tiles().size(); i += 10) {
    const Eigen::Vector3i tile = whole_.tiles()[i];
    EXPECT_TRUE(is_same(limited_.extract_tile(tile).value(), whole_.extract_tile(tile).value()));
    EXPECT_TRUE(limited_.pack_tile(tile).value() == whole_.pack_tile(tile).value());
    EXPECT_FALSE(limited_.unpack_tile(tile, whole_.pack_tile(tile).value())) << "it is there already";
  }
}

TEST_F(TilePagerTest, WhatWasPutAwayIsTakenBackToTheLastBit) {
  integrate_all();
  for (const std::size_t view : {0U, 2U}) {
    const image::RectifiedFrame frame = empty_room().render(camera_, poses_[view]);
    for (TsdfMap* map : {&whole_, &limited_}) {
      ASSERT_TRUE(map->deintegrate(frame, poses_[view]));
      ASSERT_TRUE(map->keep_budget());
    }
  }
  EXPECT_EQ(limited_.tiles(), whole_.tiles());
  EXPECT_TRUE(is_same(limited_.extract_mesh().value(), whole_.extract_mesh().value()));
  for (const std::size_t view : {1U, 3U, 4U, 5U}) {
    ASSERT_TRUE(limited_.deintegrate(empty_room().render(camera_, poses_[view]), poses_[view]));
    ASSERT_TRUE(limited_.keep_budget());
  }
  EXPECT_TRUE(limited_.tiles().empty());
  EXPECT_TRUE(vdb_of(limited_) == vdb_of(TsdfMap(options())));
}

TEST_F(TilePagerTest, AMapIsUnpackedWithinTheBudget) {
  for (std::size_t i = 0; i < poses_.size(); ++i) ASSERT_TRUE(integrate(whole_, i));
  for (const Eigen::Vector3i& tile : whole_.tiles()) {
    ASSERT_TRUE(limited_.unpack_tile(tile, whole_.pack_tile(tile).value()));
    ASSERT_TRUE(limited_.keep_budget());
    EXPECT_LT(3 * limited_.leaf_count(), whole_.leaf_count());
  }
  EXPECT_TRUE(is_same(limited_.extract_mesh().value(), whole_.extract_mesh().value()));
}

TEST_F(TilePagerTest, ReadingDoesNotWriteAgain) {
  integrate_all();
  ASSERT_TRUE(limited_.extract_mesh());
  const int writes = disk_->writes;
  ASSERT_TRUE(limited_.extract_mesh());
  EXPECT_EQ(disk_->writes, writes);
}

TEST_F(TilePagerTest, AFullDiskCostsMemoryAndNothingElse) {
  disk_->is_full = true;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    ASSERT_TRUE(integrate(whole_, i));
    ASSERT_TRUE(integrate(limited_, i));
  }
  const auto kept = limited_.keep_budget();
  ASSERT_FALSE(kept);
  EXPECT_EQ(kept.error().message, "the disk is full");
  EXPECT_EQ(limited_.leaf_count(), whole_.leaf_count());
  disk_->is_full = false;
  EXPECT_TRUE(limited_.keep_budget());
  EXPECT_LT(limited_.leaf_count(), whole_.leaf_count());
  EXPECT_TRUE(is_same(limited_.extract_mesh().value(), whole_.extract_mesh().value()));
}

TEST_F(TilePagerTest, WhatCannotBeBroughtBackIsAnErrorAndChangesNothing) {
  integrate_all();
  disk_->is_damaged = true;
  const auto summary = integrate(limited_, 0);
  ASSERT_FALSE(summary);
  EXPECT_EQ(summary.error().message, "the disk is damaged");
  EXPECT_FALSE(limited_.extract_mesh());
  std::ostringstream out;
  const auto vdb = limited_.write_vdb(out);
  ASSERT_FALSE(vdb);
  EXPECT_NE(vdb.error().message.find("the disk is damaged"), std::string::npos);
  disk_->is_damaged = false;
  EXPECT_TRUE(is_same(limited_.extract_mesh().value(), whole_.extract_mesh().value()));
}

}  // namespace
}  // namespace eg::mapping
