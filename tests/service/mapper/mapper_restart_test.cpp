#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/service/mapper/mapper_harness.hpp"

namespace eg::services {
namespace {

MapperOptions resuming() {
  MapperOptions options = coarse();
  options.resume = true;
  return options;
}

void send(Harness& mapper, int first, int end) {
  for (int i = first; i < end; ++i) {
    mapper.send_frame(i);
    mapper.send_pose(i, i % 2 == 0 ? i / 2 : -1);
  }
}

void send_correction(Harness& mapper) {
  geometry::Pose moved = mapper.true_pose(0);
  moved.translation.x() += 0.2;
  mapper.send_correction(1, 0, moved);
}

class MapperRestartTest : public ::testing::Test {
 protected:
  MapperRestartTest() {
    Harness whole(true, coarse());
    send(whole, 0, 3);
    send_correction(whole);
    send(whole, 3, 8);
    uninterrupted_ = whole.saved_mesh();
  }

  /// Ends like a killed process: nothing is saved.
  void run_and_kill() {
    Harness killed(true, coarse(), folder_.path());
    send(killed, 0, 3);
    send_correction(killed);
    send(killed, 3, 5);
  }

  [[nodiscard]] std::filesystem::path journal() const { return folder_.path() / "mapper.journal"; }

  test::TemporaryFolder folder_;
  std::string uninterrupted_;
};

TEST_F(MapperRestartTest, AKilledMapperGoesOnToTheSameMesh) {
  run_and_kill();
  Harness resumed(true, resuming(), folder_.path());
  resumed.send_frame(4);  // its acknowledgement may have been lost
  EXPECT_EQ(resumed.acknowledged.back().sequence, 4);
  send(resumed, 5, 8);
  EXPECT_EQ(resumed.acknowledged.back().sequence, 7);
  EXPECT_EQ(resumed.saved_mesh(), uninterrupted_);
}

TEST_F(MapperRestartTest, ItMayBeKilledWhileItWritesAndMoreThanOnce) {
  run_and_kill();
  std::filesystem::resize_file(journal(), std::filesystem::file_size(journal()) - 7);
  { Harness killed_again(true, resuming(), folder_.path()); }
  Harness resumed(true, resuming(), folder_.path());
  send(resumed, 4, 8);
  EXPECT_EQ(resumed.saved_mesh(), uninterrupted_);
}

TEST_F(MapperRestartTest, WithoutBeingToldToItBeginsAnew) {
  run_and_kill();
  Harness fresh(true, coarse(), folder_.path());
  EXPECT_NE(fresh.saved_mesh().find("element vertex 0\n"), std::string::npos);
}

TEST_F(MapperRestartTest, ADamagedJournalIsNamedAndRefused) {
  run_and_kill();
  std::fstream file(journal(), std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(0);
  file << "damage";
  file.close();
  const auto refused =
      service::MessageJournal::resume(journal(), [](const transport::LogEvent&) { return base::Status(); });
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("mapper.journal"), std::string::npos) << refused.error().message;
}

TEST(MapperShareTest, WritesItsShareUnderItsNumber) {
  MapperOptions options = coarse();
  options.tsdf.share = 1;
  options.tsdf.shares = 2;
  Harness mapper(true, options);
  send(mapper, 0, 1);
  EXPECT_EQ(mapper.acknowledged.back().consumer, "mapper.1");
  EXPECT_EQ(mapper.status().service, "mapper.1");
  EXPECT_TRUE(mapper.save());
  EXPECT_TRUE(std::filesystem::exists(mapper.out() / "mesh.1.ply"));
  EXPECT_TRUE(std::filesystem::exists(mapper.out() / "mesh.1.vdb"));
}

}  // namespace
}  // namespace eg::services
