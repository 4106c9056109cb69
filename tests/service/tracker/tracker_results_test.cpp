// The files that the tracker writes.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "common/io/ply.hpp"
#include "common/io/trajectory_file.hpp"
#include "tests/service/tracker/tracker_rig.hpp"

namespace eg::services {
namespace {

std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

TEST(TrackerResults, SavesTrajectoryStatesKeyframesAndMap) {
  Rig rig(true);
  for (std::size_t i = 0; i < 25; ++i) {
    rig.send_frame(i);
    rig.answer_keyframes();
  }
  rig.send(channels::kEndOfStream, messages::EndOfStream{1, 25, {frame(3).header.utime + 5}});
  ASSERT_TRUE(rig.save().has_value());

  const auto trajectory = io::read_trajectory(rig.folder() / "trajectory.txt");
  ASSERT_TRUE(trajectory.has_value()) << trajectory.error().message;
  ASSERT_EQ(trajectory->size(), 25U);
  EXPECT_NEAR((*trajectory)[24].time_s, 1e-6 * static_cast<double>(frame(24).header.utime), 1e-6);
  const geometry::Pose& truth = recording().world_from_camera[24];
  EXPECT_LT(((*trajectory)[24].world_from_camera.translation - truth.translation).norm(), 0.03);

  const std::vector<std::string> states = lines_of(rig.folder() / "states.csv");
  ASSERT_EQ(states.size(), 27U) << "a header, 25 frames and one that could not be read";
  EXPECT_EQ(states[0].rfind("sequence,time_s,state", 0), 0U) << states[0];
  EXPECT_EQ(states[1].rfind("0,1.000000,tracking", 0), 0U) << states[1];
  EXPECT_NE(states[5].find("skipped"), std::string::npos) << "in the order of time: " << states[5];

  const auto keyframes = io::read_trajectory(rig.folder() / "keyframes.txt");
  ASSERT_TRUE(keyframes.has_value());
  EXPECT_EQ(keyframes->size(), rig.keyframes->size());

  const auto map = io::read_ply(rig.folder() / "map.ply");
  ASSERT_TRUE(map.has_value()) << map.error().message;
  EXPECT_GT(map->vertices.size(), 20U);
}

TEST(TrackerResults, ListsDroppedFramesInRealTime) {
  Rig rig(false);
  rig.send_frame(0);
  rig.send_frame(3);
  rig.send(channels::kEndOfStream, messages::EndOfStream{1, 6, {}});
  ASSERT_TRUE(rig.save().has_value());
  const std::vector<std::string> states = lines_of(rig.folder() / "states.csv");
  ASSERT_EQ(states.size(), 7U) << "a header and one row per frame that was sent";
  const auto dropped = std::count_if(states.begin(), states.end(),
                                     [](const std::string& row) { return row.find(",dropped,") != std::string::npos; });
  EXPECT_EQ(dropped, 4) << "1, 2 and the two after the last that came";
}

TEST(TrackRecord, GivesEveryFrameItsOwnReasonAndNumbers) {
  const test::TemporaryFolder folder;
  TrackRecord record;
  tracking::PoseEstimate estimate;
  const auto add = [&](std::int64_t sequence, tracking::TrackingState state, const char* reason) {
    estimate.header = {1, sequence, 1'000'000 * (sequence + 1)};
    estimate.state = state;
    estimate.reason = reason;
    record.add(estimate, {});
  };
  add(0, tracking::TrackingState::initialising, "nothing \"seen\"");
  estimate.keyframe.value = 7;
  estimate.rotation_reference.value = 2;
  estimate.matched_points = 11;
  estimate.matched_lines = 12;
  estimate.matched_planes = 13;
  estimate.matched_directions = 14;
  add(1, tracking::TrackingState::lost, "searching");
  add(2, tracking::TrackingState::initialising, "nothing \"seen\"");
  ASSERT_TRUE(record.save(folder.path(), {}));
  const auto rows = lines_of(folder.path() / "states.csv");
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[1], "0,1.000000,initialising,\"nothing \"\"seen\"\"\",,,0,0,0,0");
  EXPECT_EQ(rows[2], "1,2.000000,lost,\"searching\",7,2,11,12,13,14");
  EXPECT_EQ(rows[3], "2,3.000000,initialising,\"nothing \"\"seen\"\"\",7,2,11,12,13,14");
  EXPECT_EQ(lines_of(folder.path() / "trajectory.txt").size(), 1U) << "a heading; no frame has a pose";
}

TEST(TrackerResults, AreInOrderOfTimeAlthoughAClockWasSetBack) {
  Rig rig(true);
  for (std::size_t i = 0; i < 40; ++i) {
    FrameFeatures sent = frame(i);
    if (i < 4) sent.header.utime += 2'000'000;
    rig.send(channels::kFeatures, sent);
    rig.answer_keyframes();
  }
  EXPECT_TRUE(rig.poses->back().has_pose) << "a second after the clock was set back";
  ASSERT_TRUE(rig.save());
  for (const char* name : {"trajectory.txt", "keyframes.txt"}) {
    const auto read = io::read_trajectory(rig.folder() / name);
    EXPECT_TRUE(read) << read.error().message;
  }
}

TEST(TrackerResults, SavesEmptyFilesWhenNothingCame) {
  Rig rig(true);
  ASSERT_TRUE(rig.save().has_value());
  EXPECT_EQ(lines_of(rig.folder() / "states.csv").size(), 1U);
  EXPECT_TRUE(std::filesystem::exists(rig.folder() / "trajectory.txt"));
}

}  // namespace
}  // namespace eg::services
