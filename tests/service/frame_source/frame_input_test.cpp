#include "services/frame_source/frame_input.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "services/frame_source/read_ahead.hpp"
#include "tests/service/frame_source/fake_input.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg {
namespace {

using services::InputOptions;
using testing::HasSubstr;

/// A recording of `count` frames of 640 x 480 in ICL-NUIM's layout without lists.
void write_recording(const test::TemporaryFolder& folder, int count) {
  for (const char* name : {"rgb", "depth"}) std::filesystem::create_directories(folder.path() / name);
  for (int i = 0; i < count; ++i) {
    const std::string file = std::to_string(i) + ".png";
    cv::imwrite((folder.path() / "rgb" / file).string(), cv::Mat(480, 640, CV_8UC3, cv::Scalar(10, 20, i)));
    cv::imwrite((folder.path() / "depth" / file).string(), cv::Mat(480, 640, CV_16UC1, cv::Scalar(5000)));
  }
}

TEST(FrameInput, ReadsARecordingUpToTheFrameLimit) {
  const test::TemporaryFolder folder;
  write_recording(folder, 3);
  const auto input = services::open_input({.dataset = folder.path().string(), .camera = "icl", .max_frames = 2});
  ASSERT_TRUE(input.has_value()) << input.error().message;
  EXPECT_EQ((*input)->size(), 2);
  EXPECT_TRUE((*input)->ground_truth().empty());
  const auto frame = (*input)->read(1);
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(std::get<messages::CompressedFrame>(*frame).camera.name, "icl");
  EXPECT_EQ((*input)->utime(1), 33'333);
}

TEST(FrameInput, AddsNoiseToDepthOnly) {
  const test::TemporaryFolder folder;
  write_recording(folder, 2);
  const auto read = [&](std::int64_t seed, std::int64_t index) {
    InputOptions options;
    options.dataset = folder.path().string();
    options.camera = "icl";
    options.depth_noise = seed;
    return *messages::decompress(
        std::get<messages::CompressedFrame>(*services::open_input(options).value()->read(index)));
  };
  const auto differ = [](const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) > 0.0; };
  EXPECT_TRUE(differ(read(0, 0).depth, read(1, 0).depth));
  EXPECT_FALSE(differ(read(0, 0).colour, read(1, 0).colour));
  EXPECT_FALSE(differ(read(1, 0).depth, read(1, 0).depth));
  EXPECT_TRUE(differ(read(1, 0).depth, read(2, 0).depth));
  EXPECT_TRUE(differ(read(1, 0).depth, read(1, 1).depth));
  EXPECT_NEAR(cv::mean(read(1, 0).depth)[0], 5000.0, 25.0);
}

TEST(FrameInput, AFormatThatDoesNotFitIsAnErrorAtOnce) {
  const test::TemporaryFolder folder;
  write_recording(folder, 1);
  cv::imwrite((folder.path() / "depth/0.png").string(), cv::Mat(480, 640, CV_8UC1, cv::Scalar(5)));
  const auto input = services::open_input({.dataset = folder.path().string(), .camera = "icl"});
  ASSERT_FALSE(input.has_value());
  EXPECT_THAT(input.error().message, HasSubstr("depth/0.png"));
}

TEST(FrameInput, ATruncatedImageInTheMiddleFailsAlone) {
  const test::TemporaryFolder folder;
  write_recording(folder, 3);
  std::filesystem::resize_file(folder.path() / "rgb/1.png", 100);
  const auto input = services::open_input({.dataset = folder.path().string(), .camera = "icl"});
  ASSERT_TRUE(input.has_value()) << input.error().message;
  const auto frame = (*input)->read(1);
  ASSERT_FALSE(frame.has_value());
  EXPECT_THAT(frame.error().message, HasSubstr("rgb/1.png"));
  EXPECT_TRUE((*input)->read(2).has_value());
}

TEST(FrameInput, NamesWhatItDoesNotKnow) {
  for (const auto& [options, expected] : std::vector<std::pair<InputOptions, std::string>>{
           {{.dataset = "/no/such/folder"}, "/no/such/folder"},
           {{.dataset = "synthetic:castle"}, "castle"},
           {{.dataset = "synthetic:corner:dance"}, "dance"},
           {{.dataset = "synthetic:corner", .camera = "camera9"}, "camera9"},
           {{.dataset = "synthetic:corner", .camera = "", .max_frames = -1}, "negative"}}) {
    const auto input = services::open_input(options);
    ASSERT_FALSE(input.has_value()) << expected;
    EXPECT_THAT(input.error().message, HasSubstr(expected));
  }
}

TEST(FrameInput, SyntheticScenesTakeAnotherTrajectory) {
  const auto input = services::open_input({.dataset = "synthetic:room:spin", .camera = "", .max_frames = 20});
  ASSERT_TRUE(input.has_value()) << input.error().message;
  const auto poses = (*input)->ground_truth();
  ASSERT_EQ(poses.size(), 20U);
  EXPECT_EQ(poses.front().world_from_camera.translation, poses.back().world_from_camera.translation);
}

TEST(FrameInput, SyntheticScenesTakeAnyCamera) {
  const auto input = services::open_input({.dataset = "synthetic:corner", .camera = "icl", .max_frames = 2});
  ASSERT_TRUE(input.has_value()) << input.error().message;
  const auto frame = (*input)->read(1);
  ASSERT_TRUE(frame.has_value());
  EXPECT_LT(std::get<messages::CompressedFrame>(*frame).camera.fy, 0.0);
  EXPECT_EQ((*input)->ground_truth().size(), 2U);
}

TEST(ReadAhead, GivesEveryFrameOnceInOrderAndFailuresInTheirPlace) {
  services::ReadAhead reader(std::make_shared<test::FakeInput>(50, std::set<std::int64_t>{10, 11}), 2);
  for (std::int64_t i = 0; i < 50; ++i) {
    EXPECT_FALSE(reader.exhausted());
    const auto item = reader.take(std::chrono::seconds(10));
    ASSERT_TRUE(item.has_value());
    EXPECT_EQ(item->index, i);
    EXPECT_EQ(item->frame.has_value(), i != 10 && i != 11);
    if (item->frame) {
      EXPECT_EQ(test::FakeInput::index_of(*item->frame), i);
    }
  }
  EXPECT_TRUE(reader.exhausted());
  EXPECT_FALSE(reader.take(std::chrono::milliseconds(0)).has_value());
}

TEST(ReadAhead, EndsWhileFramesAreWaiting) {
  const services::ReadAhead reader(std::make_shared<test::FakeInput>(50), 2);
  EXPECT_FALSE(reader.exhausted());
}

}  // namespace
}  // namespace eg
