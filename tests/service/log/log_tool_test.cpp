#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/io/dataset.hpp"
#include "common/io/trajectory_file.hpp"
#include "common/messages/channels.hpp"
#include "common/transport/event_log.hpp"
#include "services/log/extract.hpp"
#include "services/log/log_summary.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::log_tool {
namespace {

using testing::HasSubstr;
namespace channels = messages::channels;

constexpr int kPeriod = 100'000;  // microseconds

image::RgbdFrame frame(std::int64_t session, std::int64_t sequence) {
  const geometry::CameraModel camera{"tiny", 16, 12, 20, 20, 7.5, 5.5, {}, 1000, 10};
  return {{session, sequence, kPeriod * (1 + sequence)},
          camera,
          cv::Mat(12, 16, CV_8UC3, cv::Scalar::all(100)),
          cv::Mat(12, 16, CV_16UC1, cv::Scalar(static_cast<double>(500 + sequence)))};
}

class LogTool : public testing::Test {
 protected:
  template <typename T>
  void write(const std::string& channel, const T& message, std::int64_t utime) {
    ASSERT_TRUE(writer_.write(channel, messages::encode(message), utime));
  }
  /// Frames, features and poses of one session: frame 2 was lost, frame 3 came twice, frame 4 has no pose.
  void write_session(const std::string& prefix, std::int64_t session) {
    for (const std::int64_t sequence : {0, 1, 3, 3, 4}) {
      const image::RgbdFrame images = frame(session, sequence);
      write(prefix + channels::kRgbd, images, kPeriod * sequence);
      features::FrameFeatures features;
      features.header = images.header;
      features.camera = images.camera;
      features.points.resize(3);
      features.planes.resize(1);
      features.planes[0].plane.distance = 1.0;
      write(prefix + channels::kFeatures, features, kPeriod * sequence + 1);
      tracking::PoseEstimate pose;
      pose.header = images.header;
      pose.has_pose = sequence != 4;
      pose.world_from_camera.translation.x() = static_cast<double>(sequence);
      write(prefix + channels::kPose, pose, kPeriod * sequence + 2);
    }
    ASSERT_TRUE(writer_.flush());
  }

  test::TemporaryFolder folder_;
  std::filesystem::path log_ = folder_.path() / "run.lcm";
  transport::EventLogWriter writer_ = transport::EventLogWriter::create(log_).value();
};

TEST_F(LogTool, ListsChannelsWithGapsAndRepetitions) {
  write_session("", 7);
  ASSERT_TRUE(writer_.write("FOREIGN", std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9}, 5));
  ASSERT_TRUE(writer_.write("POSE", std::vector<std::uint8_t>{1, 2}, 500'000));
  ASSERT_TRUE(writer_.flush());
  const auto summary = summarise(log_);
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(summary->events, 17);
  const auto& rgbd = summary->streams.channels().at("RGBD");
  EXPECT_EQ(rgbd.type, "rgbd_t");
  EXPECT_EQ(rgbd.messages, 5);
  EXPECT_EQ(rgbd.missing(), 1);
  EXPECT_EQ(rgbd.repeated(), 1);
  EXPECT_DOUBLE_EQ(rgbd.seconds(), 0.4);
  EXPECT_DOUBLE_EQ(rgbd.rate(), 10.0);
  EXPECT_TRUE(rgbd.sessions.contains(7));
  const auto& pose = summary->streams.channels().at("POSE");
  EXPECT_EQ(pose.type, "mixed");
  EXPECT_EQ(pose.rejected, 1);
  EXPECT_EQ(summary->streams.channels().at("FOREIGN").type, "0102030405060708");
  EXPECT_THAT(format_table(*summary), HasSubstr("last refusal: the message is shorter than a fingerprint"));
  const auto json = nlohmann::json::parse(format_json(*summary));
  EXPECT_EQ(json["channels"]["RGBD"]["missing"], 1);
}

TEST_F(LogTool, ListsChannelsWhoseNamesAreNoText) {
  ASSERT_TRUE(writer_.write("A\x1b[2J\xff", std::vector<std::uint8_t>(9, 1), 5));
  ASSERT_TRUE(writer_.flush());
  const auto summary = summarise(log_);
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_THAT(format_table(*summary), testing::AllOf(HasSubstr("\nA [2J"), testing::Not(HasSubstr("\x1b"))));
  EXPECT_TRUE(nlohmann::json::parse(format_json(*summary))["channels"].contains("A\x1b[2J\uFFFD"));
}

TEST_F(LogTool, CountsTheSecondsBetweenTimesThatNoClockSays) {
  for (const std::int64_t utime : {INT64_MIN, INT64_MAX}) write("STATUS", messages::ServiceStatus{}, utime);
  ASSERT_TRUE(writer_.flush());
  const auto summary = summarise(log_);
  ASSERT_TRUE(summary) << summary.error().message;
  const auto& status = summary->streams.channels().at("STATUS");
  EXPECT_DOUBLE_EQ(status.seconds(), 18'446'744'073'709.551616);
  EXPECT_GT(status.rate(), 0.0);
  EXPECT_THAT(format_table(*summary), HasSubstr("2 messages in 18446744073709.6 s"));
}

TEST_F(LogTool, SaysWhereALogIsDamaged) {
  write_session("", 1);
  std::filesystem::resize_file(log_, std::filesystem::file_size(log_) - 5);
  const auto summary = summarise(log_);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->events, 14);
  EXPECT_EQ(summary->damaged_places, 1);
  EXPECT_THAT(format_table(*summary), HasSubstr("ends within an event (byte "));
  EXPECT_FALSE(summarise(folder_.path() / "absent.lcm"));
}

TEST_F(LogTool, ExtractedImagesAreADataSetWithTheRecordedBytes) {
  write_session("", 1);
  const auto folder = folder_.path() / "images";
  const auto count = extract_images(log_, {}, folder);
  ASSERT_TRUE(count) << count.error().message;
  EXPECT_EQ(*count, 4);
  const auto dataset = io::open_dataset(folder);
  ASSERT_TRUE(dataset) << dataset.error().message;
  ASSERT_EQ(dataset->frames.size(), 4U);
  EXPECT_EQ(dataset->frames[2].utime, 4 * kPeriod);
  const image::RgbdFrame expected = frame(1, 3);
  const auto read = io::read_frame(*dataset, 2, expected.camera);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->depth.at<std::uint16_t>(0, 0), 503);
}

TEST_F(LogTool, ExtractsPosesAndFeatures) {
  write_session("", 1);
  const auto poses = folder_.path() / "poses.txt";
  EXPECT_EQ(extract_poses(log_, {}, poses).value(), 3);
  const auto trajectory = io::read_trajectory(poses);
  ASSERT_TRUE(trajectory);
  EXPECT_DOUBLE_EQ(trajectory->at(2).time_s, 0.4);
  EXPECT_DOUBLE_EQ(trajectory->at(2).world_from_camera.translation.x(), 3.0);

  const auto features = folder_.path() / "features.csv";
  EXPECT_EQ(extract_features(log_, {}, features).value(), 16);
  std::stringstream text;
  text << std::ifstream(features).rdbuf();
  EXPECT_THAT(text.str(), HasSubstr("3,400000,plane,0,0,1,1\n"));
}

TEST_F(LogTool, ExtractsOneOfSeveralRobots) {
  write_session("", 1);
  write_session("", 2);
  write_session("R2_", 1);
  const auto poses = folder_.path() / "poses.txt";
  EXPECT_THAT(extract_poses(log_, {}, poses).error().message, HasSubstr("holds sessions 1 and 2"));
  EXPECT_EQ(extract_poses(log_, {.channel_prefix = "", .session = 2}, poses).value(), 3);
  EXPECT_EQ(extract_poses(log_, {.channel_prefix = "R2_", .session = {}}, poses).value(), 3);
  EXPECT_THAT(extract_poses(log_, {.channel_prefix = "R3_", .session = {}}, poses).error().message, HasSubstr("POSE"));
}

}  // namespace
}  // namespace eg::log_tool
