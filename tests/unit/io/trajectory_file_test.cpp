#include "common/io/trajectory_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/random.hpp"
#include "common/geometry/so3.hpp"
#include "common/io/text_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::io {
namespace {

using testing::HasSubstr;

class TrajectoryFile : public testing::Test {
 protected:
  base::Result<std::vector<geometry::StampedPose>> read(std::string_view text) {
    return read_trajectory(folder_.write("t.txt", text));
  }
  std::string error(std::string_view text) {
    const auto trajectory = read(text);
    EXPECT_FALSE(trajectory.has_value()) << text;
    return trajectory ? "" : trajectory.error().message;
  }
  test::TemporaryFolder folder_;
};

TEST_F(TrajectoryFile, ReadsTheTumFormat) {
  const auto trajectory = read("# comment\n1.5 1 2 3 0 0 0.70710678 0.70710678\n2.25 4 5 6 0 0 0 -1\r\n");
  ASSERT_TRUE(trajectory.has_value()) << trajectory.error().message;
  ASSERT_EQ(trajectory->size(), 2U);
  EXPECT_EQ((*trajectory)[0].time_s, 1.5);
  EXPECT_EQ((*trajectory)[0].world_from_camera.translation, Eigen::Vector3d(1, 2, 3));
  // A quarter turn about z takes x to y.
  EXPECT_TRUE(
      ((*trajectory)[0].world_from_camera.rotation * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_TRUE((*trajectory)[1].world_from_camera.rotation.isIdentity());
}

TEST_F(TrajectoryFile, SmallIntegersAreImageNumbers) {
  auto trajectory = read("0 0 0 0 0 0 0 1\n45 0 0 0 0 0 0 1\n");
  EXPECT_EQ((*trajectory)[1].time_s, 1.5);
  trajectory = read("0 0 0 0 0 0 0 1\n45.0 0 0 0 0 0 0 1\n");
  EXPECT_EQ((*trajectory)[1].time_s, 45.0);
  trajectory = read("1341836537 0 0 0 0 0 0 1\n");
  EXPECT_EQ((*trajectory)[0].time_s, 1341836537.0);
}

TEST_F(TrajectoryFile, WhatIsWrittenIsRead) {
  base::Random random(5);
  std::vector<geometry::StampedPose> written;
  for (int i = 0; i < 100; ++i) {
    geometry::StampedPose pose;
    pose.time_s = 1341836537.655662 + i / 30.0;
    pose.world_from_camera.rotation =
        geometry::so3_exp(3.0 * Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
    pose.world_from_camera.translation = {random.normal(), random.normal(), random.normal()};
    written.push_back(pose);
  }
  const auto path = folder_.path() / "w.txt";
  ASSERT_TRUE(write_trajectory(path, written).has_value());
  const auto read_back = read_trajectory(path);
  ASSERT_TRUE(read_back.has_value()) << read_back.error().message;
  ASSERT_EQ(read_back->size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    const geometry::Pose &a = written[i].world_from_camera, &b = (*read_back)[i].world_from_camera;
    EXPECT_NEAR(written[i].time_s, (*read_back)[i].time_s, 1e-6);
    EXPECT_LT((a.translation - b.translation).norm(), 1e-8);
    EXPECT_LT(geometry::rotation_angle_between(a.rotation, b.rotation), 1e-8);
  }
  EXPECT_EQ(format_trajectory(*read_back), *read_file(path));
}

TEST_F(TrajectoryFile, FormattingIsFixed) {
  geometry::StampedPose pose{1341836537.655662, {}};
  pose.world_from_camera.translation = {-0.0, 1.0 / 3.0, 1e-7};
  EXPECT_EQ(format_trajectory({&pose, 1}),
            "# time tx ty tz qx qy qz qw (camera to world)\n"
            "1341836537.655662 0 0.333333333 1e-07 0 0 0 1\n");
}

TEST_F(TrajectoryFile, SaysWhatIsWrong) {
  EXPECT_THAT(error(""), HasSubstr("t.txt: holds no pose"));
  EXPECT_THAT(error("1.0 1 2 3 0 0 0\n"), HasSubstr("t.txt:1: expected 'time tx ty tz qx qy qz qw', found '1.0 1 2 3"));
  EXPECT_THAT(error("1.0 1 2 nan 0 0 0 1\n"), HasSubstr("t.txt:1: 'nan' is not a number"));
  EXPECT_THAT(error("# x\nlater 1 2 3 0 0 0 1\n"), HasSubstr("t.txt:2: 'later' is not a time stamp"));
  EXPECT_THAT(error("1.0 1 2 3 0 0 0 2\n"), HasSubstr("t.txt:1: the quaternion's norm is 2, not 1"));
  EXPECT_THAT(error("1.0 1 2 3 0 0 0 0\n"), HasSubstr("t.txt:1: the quaternion's norm is 0, not 1"));
  EXPECT_THAT(error("1.0 1 2 3 0 0 0 1\n1.0 1 2 3 0 0 0 1\n"),
              HasSubstr("t.txt:2: time stamp is not later than that of line 1"));
  EXPECT_THAT(read_trajectory(folder_.path() / "none").error().message,
              HasSubstr("none: cannot be read: No such file"));
  const geometry::StampedPose pose;
  EXPECT_EQ(write_trajectory("/no/such/folder/t.txt", {&pose, 1}).error().message,
            "/no/such/folder/t.txt: cannot be written: No such file or directory");
}

}  // namespace
}  // namespace eg::io
