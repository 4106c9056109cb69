#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/service/mapper/mapper_harness.hpp"

namespace eg::services {
namespace {

/// The map of the frames below takes some MB.
MapperOptions limited() {
  MapperOptions options = coarse();
  options.memory_mb = 1;
  return options;
}

void send(Harness& mapper, int first, int end) {
  for (int i = first; i < end; ++i) {
    mapper.send_frame(i * 30, i);
    mapper.send_pose(i * 30, i, i);
  }
}

void move_keyframe(Harness& mapper, int keyframe) {
  geometry::Pose moved = mapper.true_pose(keyframe * 30);
  moved.translation.x() += 0.2;
  mapper.send_correction(keyframe + 1, keyframe, moved);
}

std::filesystem::path tiles_of(const Harness& mapper) { return mapper.out() / "mapper.tiles"; }

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

TEST(MapperMemoryTest, ResultsDoNotDependOnTheBudget) {
  test::TemporaryFolder folder;
  Harness whole(true, coarse());
  {
    Harness mapper(true, limited(), folder.path());
    for (Harness* each : {&whole, &mapper}) {
      send(*each, 0, 5);
      move_keyframe(*each, 0);
      each->idle(1'000'000);
      send(*each, 5, 8);
      ASSERT_TRUE(each->save());
    }
    EXPECT_FALSE(files_in(tiles_of(mapper)).empty());
    for (const char* name : {"mesh.ply", "mesh.pcd", "map/dense.map"}) {
      EXPECT_TRUE(read_file(mapper.out() / name) == read_file(whole.out() / name)) << name;
    }
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "mapper.tiles")) << "nothing of it is left";
}

TEST(MapperMemoryTest, WhatAKilledMapperLeftIsNotUsed) {
  test::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "mapper.tiles");
  std::ofstream(folder.path() / "mapper.tiles" / "0_0_0") << "old";
  Harness whole(true, coarse());
  Harness mapper(true, limited(), folder.path());
  EXPECT_TRUE(files_in(tiles_of(mapper)).empty());
  send(whole, 0, 3);
  send(mapper, 0, 3);
  EXPECT_TRUE(mapper.saved_mesh() == whole.saved_mesh());
}

TEST(MapperMemoryTest, ADamagedTileIsNamed) {
  Harness mapper(true, limited());
  send(mapper, 0, 8);
  const auto tiles = files_in(tiles_of(mapper));
  ASSERT_FALSE(tiles.empty());
  for (const auto& tile : tiles) {
    std::string bytes = read_file(tile);
    bytes.back() = static_cast<char>(bytes.back() ^ 1);
    std::ofstream(tile, std::ios::binary) << bytes;
  }
  const auto saved = mapper.save();
  ASSERT_FALSE(saved);
  EXPECT_NE(saved.error().message.find("mapper.tiles/"), std::string::npos) << saved.error().message;
  EXPECT_NE(saved.error().message.find("wrong checksum"), std::string::npos) << saved.error().message;
  move_keyframe(mapper, 0);
  mapper.idle(1'000'000);
  EXPECT_EQ(mapper.status().rejected, 1);
  EXPECT_NE(mapper.status().last_rejection.find("keyframe 0 stays where it is"), std::string::npos)
      << mapper.status().last_rejection;
}

TEST(MapperMemoryTest, WithoutRoomOnTheDiskTheMapStaysInMemory) {
  Harness whole(true, coarse());
  Harness mapper(true, limited());
  std::filesystem::remove(tiles_of(mapper));
  std::ofstream(tiles_of(mapper)) << "no folder";  // nothing can be written into it
  send(whole, 0, 5);
  send(mapper, 0, 5);
  EXPECT_EQ(mapper.status().frames, 5);
  const auto saved = mapper.save();
  ASSERT_FALSE(saved);
  EXPECT_NE(saved.error().message.find("mapper.tiles/"), std::string::npos) << saved.error().message;
  std::filesystem::remove(tiles_of(mapper));
  std::filesystem::create_directory(tiles_of(mapper));
  EXPECT_TRUE(mapper.saved_mesh() == whole.saved_mesh());
}

}  // namespace
}  // namespace eg::services
