#include "services/mapper/mapper_service.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <string>

#include "common/io/ply.hpp"
#include "services/mapper/mapper_config.hpp"
#include "tests/service/mapper/mapper_harness.hpp"

namespace eg::services {
namespace {

TEST(MapperServiceTest, FusesKeyframesAndAcknowledgesEveryFrame) {
  Harness mapper(true, coarse());
  for (int i = 0; i < 4; ++i) {
    mapper.send_frame(i);
    EXPECT_EQ(mapper.acknowledged.size(), static_cast<std::size_t>(i)) << "before its pose is known";
    mapper.send_pose(i, i == 0 ? 0 : i == 3 ? 1 : -1);
    ASSERT_EQ(mapper.acknowledged.size(), static_cast<std::size_t>(i + 1));
    EXPECT_EQ(mapper.acknowledged.back().sequence, i);
    EXPECT_EQ(mapper.acknowledged.back().session, 7);
    EXPECT_EQ(mapper.acknowledged.back().consumer, "mapper");
  }
  EXPECT_EQ(mapper.status().frames, 2);
  EXPECT_GT(mapper.saved_vertices(), 500U);
  EXPECT_GT(std::filesystem::file_size(mapper.out() / "mesh.vdb"), 10'000U);
}

TEST(MapperServiceTest, WorksOffWhatComesOutOfOrder) {
  Harness in_order(true, coarse());
  for (int i = 0; i < 3; ++i) {
    in_order.send_frame(i);
    in_order.send_pose(i, i);
  }
  Harness mapper(true, coarse());
  mapper.send_pose(1, 1);
  mapper.send_frame(2);
  mapper.send_frame(1);
  mapper.send_pose(2, 2);
  mapper.send_pose(0, 0);
  EXPECT_TRUE(mapper.acknowledged.empty());
  mapper.send_frame(0);
  ASSERT_FALSE(mapper.acknowledged.empty());
  EXPECT_EQ(mapper.acknowledged.back().sequence, 2);
  EXPECT_EQ(mapper.saved_mesh(), in_order.saved_mesh());
}

TEST(MapperServiceTest, AcknowledgesAFinishedFrameAgainWithoutFusingItAgain) {
  Harness mapper(true, coarse());
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  const std::string once = mapper.saved_mesh();
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  EXPECT_EQ(mapper.acknowledged.size(), 2U);
  EXPECT_EQ(mapper.acknowledged.back().sequence, 0);
  EXPECT_EQ(mapper.saved_mesh(), once);
  EXPECT_EQ(mapper.status().frames, 1);
}

TEST(MapperServiceTest, KeepsOutWhatWasNotTracked) {
  using State = tracking::TrackingState;
  Harness mapper(true, coarse());
  int index = 0;
  for (const State state : {State::initialising, State::rotation_only, State::lost}) {
    mapper.send_frame(index);
    mapper.send_pose(index, index, state);
    ++index;
  }
  EXPECT_EQ(mapper.acknowledged.size(), 3U);
  EXPECT_NE(mapper.saved_mesh().find("element vertex 0\n"), std::string::npos);
  EXPECT_EQ(mapper.status().frames, 0);
}

TEST(MapperServiceTest, RejectsAnotherSession) {
  Harness mapper(true, coarse());
  mapper.send_frame(0);
  mapper.send_pose(0, 0, tracking::TrackingState::tracking, 8);
  EXPECT_TRUE(mapper.acknowledged.empty());
  EXPECT_EQ(mapper.status().rejected, 1);
  EXPECT_NE(mapper.status().last_rejection.find("session"), std::string::npos);
}

void map_frames(Harness& mapper, std::int64_t session, int count) {
  mapper.session_of_frames = session;
  for (int i = 0; i < count; ++i) {
    mapper.send_frame(i);
    mapper.send_pose(i, i, tracking::TrackingState::tracking, session);
  }
}

TEST(MapperServiceTest, AnotherSessionGetsAMapOfItsOwnWhenTheFirstHasEnded) {
  Harness alone(true, coarse());
  map_frames(alone, 7, 2);
  const std::string mesh = alone.saved_mesh();

  Harness mapper(true, coarse());
  map_frames(mapper, 8, 3);
  map_frames(mapper, 7, 2);
  EXPECT_EQ(mapper.acknowledged.back().session, 8) << "it still goes on";
  mapper.session_of_frames = 8;
  mapper.send_end(3);
  map_frames(mapper, 7, 2);
  EXPECT_EQ(mapper.acknowledged.back().session, 7);
  EXPECT_EQ(mapper.saved_mesh(), mesh);
  EXPECT_FALSE(read_file(mapper.out() / "session-8" / "mesh.ply").empty());
  EXPECT_NE(read_file(mapper.out() / "session-8" / "mesh.ply"), mesh);
  map_frames(mapper, 8, 1);
  EXPECT_EQ(mapper.acknowledged.back().session, 7) << "what comes late of an old session begins none";
}

TEST(MapperServiceTest, AnotherSessionMayBeginWhenTheFirstIsSilent) {
  Harness mapper(false, coarse());
  mapper.idle(10'000'000);
  map_frames(mapper, 7, 2);
  mapper.idle(11'000'000);
  map_frames(mapper, 8, 1);
  EXPECT_EQ(mapper.status().frames, 2);
  mapper.idle(13'000'000);
  map_frames(mapper, 8, 1);
  EXPECT_EQ(mapper.status().frames, 3);
}

TEST(MapperServiceTest, InRealTimeCountsAKeyframeWhoseImagesAreGone) {
  Harness mapper(false, coarse());
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  mapper.send_frame(1);  // 2 is lost
  mapper.send_pose(2, 1);
  mapper.send_frame(3);
  mapper.send_pose(3, 2);
  EXPECT_TRUE(mapper.acknowledged.empty());
  EXPECT_EQ(mapper.status().frames, 2);
  for (int period = 0; period < 30; ++period) mapper.idle(1'000'000 + 300'000 * period);  // nobody has it any more
  EXPECT_EQ(mapper.status().dropped, 1);
}

TEST(MapperServiceTest, InRealTimeAPoseMayComeBeforeItsImages) {
  Harness mapper(false, coarse());
  mapper.send_pose(0, 0);
  mapper.send_pose(1, 1);
  mapper.send_frame(1);
  mapper.send_frame(0);
  EXPECT_EQ(mapper.status().frames, 2);
}

TEST(MapperServiceTest, InRealTimeFramesWithAbsurdNumbersTakeNoPlaceForLong) {
  MapperOptions options = coarse();
  options.plane_regularisation = false;
  Harness mapper(false, options);
  mapper.features_come = false;
  constexpr int kMoreThanItKeeps = 40;
  for (int i = 0; i < kMoreThanItKeeps; ++i) mapper.send_frame(0, 1'000'000'000 + i);
  for (int i = 0; i < 3; ++i) {
    mapper.send_frame(i);
    mapper.send_pose(i, i);
  }
  EXPECT_EQ(mapper.status().frames, 3);
}

TEST(MapperServiceTest, ACorrectedMapIsTheMapOfTheCorrectedPoses) {
  Harness right(true, coarse());
  for (int i = 0; i < 3; ++i) {
    right.send_frame(i);
    right.send_pose(i, i);
  }
  // The same with one keyframe that was tracked wrongly at first.
  Harness mapper(true, coarse());
  geometry::Pose wrong = mapper.true_pose(1);
  wrong.translation += Eigen::Vector3d(0.3, -0.1, 0.2);
  for (int i = 0; i < 3; ++i) {
    mapper.send_frame(i);
    mapper.send_pose(i, i);
  }
  mapper.send_correction(1, 1, wrong);
  mapper.idle(0);
  EXPECT_NE(mapper.saved_mesh(), right.saved_mesh());
  mapper.send_correction(2, 1, mapper.true_pose(1));
  mapper.send_correction(1, 1, wrong);  // late
  mapper.idle(20'000);
  EXPECT_EQ(mapper.saved_mesh(), right.saved_mesh());
}

TEST(MapperServiceTest, ACorrectionMayComeBeforeItsKeyframeAndBeSmall) {
  Harness early(true, coarse());
  Harness late(true, coarse());
  geometry::Pose moved = early.true_pose(0);
  moved.translation.x() += 0.004;
  early.send_correction(1, 0, moved);
  for (Harness* mapper : {&early, &late}) {
    mapper->send_frame(0);
    mapper->send_pose(0, 0);
  }
  const std::string unmoved = late.saved_mesh();
  late.send_correction(1, 0, moved);
  EXPECT_NE(late.saved_mesh(), unmoved);
  EXPECT_EQ(late.saved_mesh(), early.saved_mesh());
}

TEST(MapperServiceTest, WithoutABudgetForImagesKeyframesStay) {
  MapperOptions options = coarse();
  options.image_budget = 0;
  Harness mapper(true, options);
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  const std::string before = mapper.saved_mesh();
  mapper.send_correction(1, 0, mapper.true_pose(60));
  mapper.idle(0);
  EXPECT_EQ(mapper.saved_mesh(), before);
}

TEST(MapperServiceTest, StreamsTheWholeMeshAndRepeatsIt) {
  Harness mapper(true, coarse());
  mapper.idle(1);
  EXPECT_TRUE(mapper.chunks.empty());
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  std::int64_t now = 2'000'000;
  for (int round = 0; round < 100; ++round) mapper.idle(now += 20'000);
  std::set<std::array<int, 3>> tiles;
  std::size_t triangles = 0;
  std::size_t first_pass = 0;
  for (const mapping::MeshChunk& chunk : mapper.chunks) {
    EXPECT_EQ(chunk.session, 7);
    EXPECT_EQ(chunk.revision, 0);
    EXPECT_DOUBLE_EQ(chunk.tile_size, 32 * 0.05);
    if (!tiles.insert({chunk.tile.x(), chunk.tile.y(), chunk.tile.z()}).second) break;
    triangles += chunk.mesh.triangles.size();
    ++first_pass;
  }
  mapper.saved_mesh();
  EXPECT_EQ(triangles, io::read_ply(mapper.out() / "mesh.ply").value().triangles.size());
  EXPECT_GT(mapper.chunks.size(), first_pass) << "for viewers that came late";

  mapper.chunks.clear();
  mapper.send_frame(1);
  mapper.send_pose(1, 1);
  for (int round = 0; round < 60; ++round) mapper.idle(now += 20'000);
  ASSERT_FALSE(mapper.chunks.empty());
  EXPECT_EQ(mapper.chunks[0].revision, 1);
}

TEST(MapperServiceTest, AnOutputFolderThatIsGoneIsAnError) {
  Harness mapper(true, coarse());
  std::filesystem::remove_all(mapper.out());
  const auto saved = mapper.save();
  ASSERT_FALSE(saved);
  EXPECT_NE(saved.error().message.find("mesh.ply"), std::string::npos) << saved.error().message;
}

TEST(MapperConfigTest, SetsEveryOption) {
  MapperOptions options;
  io::ConfigSchema schema;
  describe_options(schema, options);
  ASSERT_TRUE(io::parse_config(
      "voxel_size: 0.01\nmesh_period: 0\nimage_budget: 12\nmemory_mb: 34\nplane_regularisation: false\n", "test",
      schema));
  EXPECT_EQ(options.tsdf.voxel_size, 0.01);
  EXPECT_EQ(options.mesh_period, 0.0);
  EXPECT_EQ(options.image_budget, 12);
  EXPECT_EQ(options.memory_mb, 34);
  EXPECT_FALSE(options.plane_regularisation);
  EXPECT_FALSE(io::parse_config("voxel_sise: 0.01\n", "test", schema));
  EXPECT_FALSE(io::parse_config("voxel_size: 0\n", "test", schema));
}

}  // namespace
}  // namespace eg::services
