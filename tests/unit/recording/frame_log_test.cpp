#include "common/recording/frame_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "common/messages/channels.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::recording {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

messages::CompressedFrame frame(std::int64_t session, std::int64_t sequence) {
  const geometry::CameraModel camera{"tiny", 16, 12, 20, 20, 7.5, 5.5, {}, 1000, 10};
  return messages::compress({{session, sequence, 1'000'000 + 33'000 * sequence},
                             camera,
                             cv::Mat(12, 16, CV_8UC3, cv::Scalar::all(100)),
                             cv::Mat(12, 16, CV_16UC1, cv::Scalar(static_cast<double>(1 + sequence)))});
}

class FrameLogTest : public testing::Test {
 protected:
  template <typename T>
  void write(const std::string& channel, const T& message) {
    ASSERT_TRUE(writer_.write(channel, messages::encode(message), 1));
  }
  void write_frames(const std::string& channel, std::int64_t session, const std::vector<std::int64_t>& sequences) {
    for (const std::int64_t sequence : sequences) write(channel, frame(session, sequence));
  }
  base::Result<FrameLog> open(const FrameLog::Options& options = {}) {
    EXPECT_TRUE(writer_.flush());
    return FrameLog::open(path_, options);
  }
  static std::vector<std::int64_t> sequences(const FrameLog& log) {
    std::vector<std::int64_t> result;
    for (const image::FrameHeader& header : log.frames()) result.push_back(header.sequence);
    return result;
  }

  test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "run.lcm";
  transport::EventLogWriter writer_ = transport::EventLogWriter::create(path_).value();
};

TEST_F(FrameLogTest, GivesEachFrameOnceInOrderWithTheBytesThatWereRecorded) {
  write_frames("RGBD", 3, {0, 2, 1, 1, 3, 0});
  write("END_OF_STREAM", messages::EndOfStream{3, 4, {77, 78}});
  auto log = open();
  ASSERT_TRUE(log) << log.error().message;
  EXPECT_THAT(sequences(*log), ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(log->session(), 3);
  EXPECT_EQ(log->camera().name, "tiny");
  EXPECT_THAT(log->skipped_utimes(), ElementsAre(77, 78));
  EXPECT_FALSE(log->damage().any());
  for (const std::int64_t i : {2, 0, 3, 1}) {
    const auto read = log->read(static_cast<std::size_t>(i));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(messages::encode(*read), messages::encode(frame(3, i)));
  }
}

TEST_F(FrameLogTest, AsksWhichOfSeveralStreamsIsMeant) {
  write_frames("RGBD", 1, {0, 1});
  write_frames("RGBD", 2, {0});
  write_frames("R2_RGBD", 1, {0, 1, 2});
  EXPECT_THAT(open().error().message, HasSubstr("session 1 on R2_RGBD, session 1 on RGBD, session 2 on RGBD"));
  EXPECT_EQ(open({.channel = "", .session = 2})->frames().size(), 1U);
  EXPECT_EQ(open({.channel = "R2_RGBD", .session = {}})->frames().size(), 3U);
  EXPECT_THAT(open({.channel = "RGBD", .session = 9}).error().message, HasSubstr("other frames only: session 1 on"));
}

TEST_F(FrameLogTest, CountsWhatIsMissing) {
  write_frames("RGBD", 1, {0, 1, 5});
  ASSERT_TRUE(writer_.write("RGBD", std::vector<std::uint8_t>{1, 2, 3}, 1));
  auto log = open();
  ASSERT_TRUE(log);
  EXPECT_EQ(log->damage().missing_frames, 3);
  EXPECT_EQ(log->damage().rejected, 1);
  EXPECT_THAT(describe(log->damage()), HasSubstr("3 frames are missing, 1 were rejected"));
  EXPECT_THAT(log->damage().first, HasSubstr("RGBD at byte"));
}

TEST_F(FrameLogTest, ReadsWhatIsLeftOfADamagedLog) {
  write_frames("RGBD", 1, {0, 1, 2});
  ASSERT_TRUE(writer_.flush());
  const auto event_bytes = std::filesystem::file_size(path_) / 3;
  std::fstream(path_, std::ios::in | std::ios::out | std::ios::binary)
      .seekp(static_cast<std::streamoff>(event_bytes))
      .write("lost", 4);
  auto log = open();
  ASSERT_TRUE(log) << log.error().message;
  EXPECT_THAT(sequences(*log), ElementsAre(0, 2));
  EXPECT_EQ(log->damage().places, 1);
  EXPECT_EQ(log->damage().missing_frames, 1);
  EXPECT_TRUE(log->read(1));
}

TEST_F(FrameLogTest, SaysThatThereAreNoFrames) {
  write("STATUS", messages::ServiceStatus{});
  EXPECT_THAT(open().error().message, HasSubstr("holds no colour and depth frames"));
  std::ofstream(path_) << "this is a text and certainly no log of any messages";
  EXPECT_THAT(FrameLog::open(path_, {}).error().message, HasSubstr("is no LCM log (byte 0)"));
  EXPECT_THAT(FrameLog::open(folder_.path() / "absent", {}).error().message, HasSubstr("No such file"));
}

}  // namespace
}  // namespace eg::recording
