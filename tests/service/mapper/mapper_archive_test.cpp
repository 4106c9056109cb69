#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>

#include "services/mapper/dense_archive.hpp"
#include "tests/service/mapper/mapper_harness.hpp"

namespace eg::services {
namespace {

/// Frames `first` to `end` as keyframes of the same numbers. A session counts its frames from 0.
void send(Harness& mapper, int first, int end) {
  for (int i = first; i < end; ++i) {
    mapper.send_frame(i, i - first);
    mapper.send_pose(i, i, i - first);
  }
}

void send_correction(Harness& mapper) {
  geometry::Pose moved = mapper.true_pose(0);
  moved.translation.x() += 0.2;
  mapper.send_correction(1, 0, moved);
}

class MapperArchiveTest : public ::testing::Test {
 protected:
  MapperArchiveTest() : first_(true, coarse()) {
    send(first_, 0, 3);
    const auto saved = first_.save();
    EXPECT_TRUE(saved) << saved.error().message;
  }

  [[nodiscard]] std::filesystem::path archive() const { return first_.out() / "map" / "dense.map"; }

  base::Status load(const MapperOptions& options = coarse()) const {
    KeyframeMap map(options.tsdf, 1'000'000'000);
    return load_dense_archive(archive(), map);
  }

  Harness first_;
};

TEST_F(MapperArchiveTest, ALaterSessionGoesOnToTheSameMesh) {
  Harness whole(true, coarse());
  send(whole, 0, 5);
  Harness second(true, coarse(), {}, first_.out());
  send(second, 3, 5);
  EXPECT_EQ(second.saved_mesh(), whole.saved_mesh());
}

TEST_F(MapperArchiveTest, KeyframesOfTheEarlierSessionCanStillBeCorrected) {
  Harness whole(true, coarse());
  send(whole, 0, 4);
  send_correction(whole);
  Harness second(true, coarse(), {}, first_.out());
  send(second, 3, 4);
  send_correction(second);
  EXPECT_EQ(second.saved_mesh(), whole.saved_mesh());
}

TEST_F(MapperArchiveTest, EveryDamageIsNamedAndRefused) {
  const std::string sound = read_file(archive());
  for (std::size_t at = 0; at < sound.size(); at += 1 + sound.size() / 40) {
    std::string damaged = sound;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    std::ofstream(archive(), std::ios::binary) << damaged;
    const base::Status loaded = load();
    ASSERT_FALSE(loaded) << "byte " << at;
    EXPECT_NE(loaded.error().message.find("dense.map: "), std::string::npos) << loaded.error().message;
    std::ofstream(archive(), std::ios::binary) << sound.substr(0, at);
    EXPECT_FALSE(load()) << "cut at byte " << at;
  }
}

TEST_F(MapperArchiveTest, AMapOfOtherVoxelsIsRefused) {
  MapperOptions finer = coarse();
  finer.tsdf.voxel_size = 0.04;
  const base::Status loaded = load(finer);
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().message.find("made with voxel_size 0.05"), std::string::npos) << loaded.error().message;
}

/// A limit on the size of files stands for the full disk.
TEST_F(MapperArchiveTest, AFullDiskLeavesTheOldFilesIntact) {
  const std::string mesh = read_file(first_.out() / "mesh.ply");
  const std::string map = read_file(archive());
  send(first_, 3, 5);
  rlimit old{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, old.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const base::Status saved = first_.save();
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, old_handler);
  ASSERT_FALSE(saved);
  EXPECT_NE(saved.error().message.find("cannot be written"), std::string::npos) << saved.error().message;
  EXPECT_EQ(read_file(first_.out() / "mesh.ply"), mesh);
  EXPECT_EQ(read_file(archive()), map);
  EXPECT_TRUE(first_.save());
}

}  // namespace
}  // namespace eg::services
