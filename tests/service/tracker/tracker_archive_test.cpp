#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "services/tracker/sparse_archive.hpp"
#include "tests/service/tracker/tracker_rig.hpp"

namespace eg::services {
namespace {

constexpr std::size_t kFirstSession = 25;

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// A first session's tracker with its results saved.
class TrackerArchiveTest : public ::testing::Test {
 protected:
  TrackerArchiveTest() : first_(true) {
    for (std::size_t i = 0; i < kFirstSession; ++i) {
      first_.send_frame(i);
      first_.answer_keyframes();
    }
    const auto saved = first_.save();
    EXPECT_TRUE(saved) << saved.error().message;
  }

  [[nodiscard]] std::filesystem::path archive() const { return first_.folder() / "map" / "sparse.map"; }

  Rig first_;
};

/// Frame `index` as another session's camera sends it, which has other clocks and sees nothing it knows the number of.
FrameFeatures in_new_session(std::size_t index, std::size_t first) {
  FrameFeatures features = frame(index);
  features.header.session = 99;
  features.header.sequence = static_cast<std::int64_t>(index - first);
  features.header.utime = 1000 + 33'333 * features.header.sequence;
  for (features::PointFeature& point : features.points) point.track_id = -1;
  for (features::LineFeature& line : features.lines) line.track_id = -1;
  return features;
}

TEST_F(TrackerArchiveTest, ANewSessionFindsItsPlaceAndGoesOn) {
  Rig second(true);
  ASSERT_TRUE(second.load(first_.folder()));
  // A server that knows nothing of the old map asks for it, as it does when it has lost its disk.
  auto restored = second.collect<egraph::GraphSnapshot>(channels::kRestore);
  constexpr std::size_t kStart = 15;
  std::size_t tracked = 0;
  for (std::size_t i = kStart; i < recording().frames.size(); ++i) {
    second.send(channels::kFeatures, in_new_session(i, kStart));
    if (restored->empty() && !second.keyframes->empty()) {
      second.send(channels::kRestoreRequest, messages::GraphRequest{99, 0});
      ASSERT_EQ(restored->size(), 1U);
      egraph::BuilderState state;
      ASSERT_TRUE(state.reset(restored->front()));
      second.builder = egraph::GraphBuilder({}, std::move(state));
    }
    second.answer_keyframes();
  }
  ASSERT_EQ(second.poses->size(), recording().frames.size() - kStart);
  for (std::size_t i = 0; i < second.poses->size(); ++i) {
    const PoseEstimate& pose = (*second.poses)[i];
    if (!pose.has_pose) continue;
    ++tracked;
    const geometry::Pose truth = recording().world_from_camera[kStart + i];
    EXPECT_LT((pose.world_from_camera.translation - truth.translation).norm(), 0.02) << i;
  }
  EXPECT_GE(tracked, second.poses->size() - 5) << "localised within a few frames";
  ASSERT_FALSE(second.keyframes->empty());
  EXPECT_EQ(second.keyframes->front().id.value, static_cast<std::int32_t>(first_.keyframes->size()));
}

TEST_F(TrackerArchiveTest, WhatIsLoadedIsWhatWasSaved) {
  const auto loaded = load_sparse_archive(archive());
  ASSERT_TRUE(loaded) << loaded.error().message;
  const std::string saved = read_file(archive());
  const std::filesystem::path again = first_.folder() / "again.map";
  ASSERT_TRUE(save_sparse_archive(again, loaded->map, loaded->graph));
  EXPECT_TRUE(read_file(again) == saved);
}

TEST_F(TrackerArchiveTest, EveryDamageIsNamedAndRefused) {
  const std::string sound = read_file(archive());
  for (std::size_t at = 0; at < sound.size(); at += 1 + sound.size() / 40) {
    std::string damaged = sound;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    std::ofstream(archive(), std::ios::binary) << damaged;
    const auto loaded = load_sparse_archive(archive());
    ASSERT_FALSE(loaded) << "byte " << at;
    EXPECT_NE(loaded.error().message.find("sparse.map: "), std::string::npos) << loaded.error().message;
    std::ofstream(archive(), std::ios::binary) << sound.substr(0, at);
    EXPECT_FALSE(load_sparse_archive(archive())) << "cut at byte " << at;
  }
}

TEST_F(TrackerArchiveTest, AMissingArchiveIsNamed) {
  Rig second(true);
  const base::Status loaded = second.load(first_.folder() / "elsewhere");
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().message.find("elsewhere/sparse.map"), std::string::npos) << loaded.error().message;
}

}  // namespace
}  // namespace eg::services
