#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <bot_core/images_t.hpp>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>

#include "common/codec/colour_codec.hpp"
#include "common/messages/bot_images.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/codec.hpp"
#include "common/recording/frame_log.hpp"
#include "common/synthetic/sequence.hpp"
#include "common/transport/event_log.hpp"
#include "common/transport/lcm_bus.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

/// The procman configurations for logs and cameras, with all processes.
namespace eg {
namespace {

using namespace std::chrono_literals;
using test::file_bytes;
using test::Program;

/// Tests run side by side, each in a process of its own and on a port of its own.
const std::string& url() {
  static const std::string kUrl =
      "udpm://239.255.76.67:" + std::to_string(20'000 + getpid() % 10'000) + "?ttl=0&recv_buf_size=2097152";
  return kUrl;
}
constexpr int kFrames = 12;

const std::vector<image::RgbdFrame>& frames() {
  static const std::vector<image::RgbdFrame> kRendered = [] {
    synthetic::SequenceOptions options = synthetic::sequence_named("room");
    options.session = 1;
    const auto sequence = synthetic::SyntheticSequence::make(options).value();
    std::vector<image::RgbdFrame> rendered;
    for (int i = 0; i < kFrames; ++i) {
      rendered.push_back(sequence.frame(i));
      rendered.back().header = {1, i, sequence.utime(i)};
    }
    return rendered;
  }();
  return kRendered;
}

class Configurations : public testing::Test {
 protected:
  Configurations() {
    setenv("EGRAPH_LCM_URL", url().c_str(), 1);
    setenv("EGRAPH_OUT", folder_.path().c_str(), 1);
    setenv("EGRAPH_CONSUMERS", "tracker,mapper", 1);
    unsetenv("EGRAPH_LOCKSTEP");
    bus_ = transport::LcmBus::create({url(), ""}).value();
    count(messages::channels::kPose, poses_);
    const auto note = [this](const transport::ReceivedMessage& message) {
      const auto done = messages::decode<messages::Acknowledge>(message.bytes);
      if (done && done->sequence == kFrames - 1) finished_.insert(done->consumer);
    };
    EXPECT_TRUE(bus_->subscribe(messages::channels::kAcknowledge, note, 0));
  }
  void TearDown() override { EXPECT_TRUE(test::no_process_is_left()); }

  void count(const char* channel, int& counter) {
    ASSERT_TRUE(bus_->subscribe(
        channel, [&counter](const transport::ReceivedMessage&) { ++counter; }, 0));
  }

  /// A log as lcm-logger writes it.
  std::filesystem::path write_log() {
    const auto path = folder_.path() / "input.lcm";
    auto log = transport::EventLogWriter::create(path).value();
    for (const image::RgbdFrame& frame : frames()) {
      EXPECT_TRUE(log.write(messages::channels::kRgbd, messages::encode(frame), frame.header.utime));
    }
    const messages::EndOfStream end{1, kFrames, {}};
    EXPECT_TRUE(log.write(messages::channels::kEndOfStream, messages::encode(end), frames().back().header.utime));
    EXPECT_TRUE(log.flush());
    return path;
  }

  static std::unique_ptr<Program> start(const std::string& configuration, const std::string& script) {
    const std::string file = std::string(EGRAPH_SOURCE_DIR) + "/procman/" + configuration;
    return std::make_unique<Program>("procman-sheriff", std::vector<std::string>{"--lone-ranger", file, script});
  }

  bool wait_for(const std::function<bool()>& condition, const std::function<void()>& meanwhile = {}) {
    const auto end = std::chrono::steady_clock::now() + 100s;
    while (!condition() && std::chrono::steady_clock::now() < end) {
      if (meanwhile) meanwhile();
      if (!bus_->handle(50ms)) return false;
    }
    return condition();
  }

  static void stop(Program& sheriff) {
    sheriff.send_signal(SIGINT);
    EXPECT_EQ(sheriff.wait(60s), 0) << sheriff.output();
  }

  std::int64_t saved_poses() {
    const std::string text = file_bytes(folder_.path() / "trajectory.txt");
    return std::count(text.begin(), text.end(), '\n') - 1;  // a heading
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<transport::LcmBus> bus_;
  int poses_ = 0;
  std::set<std::string> finished_;  ///< consumers that are done with the last frame
};

TEST_F(Configurations, ReplayComputesALogAnew) {
  setenv("EGRAPH_LOG", write_log().c_str(), 1);
  const auto sheriff = start("replay.pmd", "run");
  ASSERT_TRUE(wait_for([&] { return finished_.size() == 2; })) << sheriff->output();
  stop(*sheriff);
  EXPECT_EQ(saved_poses(), kFrames) << "lockstep leaves nothing out";
}

TEST_F(Configurations, PlayFeedsLiveServicesFromLcmLogplayer) {
  setenv("EGRAPH_LOG", write_log().c_str(), 1);
  setenv("EGRAPH_SPEED", "0.05", 1);
  const auto sheriff = start("play.pmd", "run");
  ASSERT_TRUE(wait_for([&] { return poses_ >= kFrames / 2; })) << sheriff->output();
  stop(*sheriff);
  EXPECT_GE(saved_poses(), kFrames / 2);
}

TEST_F(Configurations, RecordKeepsTheImages) {
  const auto sheriff = start("record.pmd", "images");
  const auto log = folder_.path() / "images.lcm.00";
  const auto size = [&] {
    std::error_code missing;
    const auto bytes = std::filesystem::file_size(log, missing);
    return missing ? std::uintmax_t{0} : bytes;
  };
  const messages::Bytes frame = messages::encode(frames()[0]);
  const auto send = [&] { ASSERT_TRUE(bus_->publish(messages::channels::kRgbd, frame)); };
  ASSERT_TRUE(wait_for([&] { return size() > 0; }, send)) << sheriff->output();
  ASSERT_TRUE(bus_->publish(messages::channels::kPose, messages::encode(tracking::PoseEstimate{})));
  const messages::Bytes next = messages::encode(frames()[1]);
  const auto send_next = [&] { ASSERT_TRUE(bus_->publish(messages::channels::kRgbd, next)); };
  const std::string next_bytes(next.begin(), next.end());
  ASSERT_TRUE(wait_for([&] { return file_bytes(log).find(next_bytes) != std::string::npos; }, send_next));
  stop(*sheriff);
  auto recorded = recording::FrameLog::open(log, {});
  ASSERT_TRUE(recorded) << recorded.error().message;
  EXPECT_EQ(recorded->frames().size(), 2U) << "each once, whatever came again";
  EXPECT_EQ(file_bytes(log).find("POSE"), std::string::npos) << "nothing but images";
}

/// What libbot2's driver of OpenNI2 cameras says.
messages::Bytes openni_frame(const image::RgbdFrame& frame) {
  const auto image_of = [&](std::int32_t pixel_format, std::vector<std::uint8_t> data) {
    bot_core::image_t image{};
    image.width = frame.colour.cols;
    image.height = frame.colour.rows;
    image.pixelformat = pixel_format;
    image.size = static_cast<std::int32_t>(data.size());
    image.data = std::move(data);
    return image;
  };
  cv::Mat millimetres;
  frame.depth.convertTo(millimetres, CV_16UC1, 1000.0 / frame.camera.depth_units_per_metre);
  std::vector<std::uint8_t> zipped(compressBound(millimetres.total() * millimetres.elemSize()));
  uLongf size = zipped.size();
  EXPECT_EQ(compress2(zipped.data(), &size, millimetres.data, millimetres.total() * millimetres.elemSize(), 1), Z_OK);
  zipped.resize(size);
  bot_core::images_t images{};
  images.utime = frame.header.utime;
  images.n_images = 2;
  images.image_types = {0, 6};
  images.images = {
      image_of(messages::bot::kPixelFormatMjpeg, codec::encode_colour(frame.colour, codec::ColourEncoding::jpeg)),
      image_of(-2, zipped)};
  messages::Bytes bytes(static_cast<std::size_t>(images.getEncodedSize()));
  images.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

TEST_F(Configurations, ALiveCameraIsTracked) {
  setenv("EGRAPH_CAMERA", "synthetic", 1);
  const auto sheriff = start("live_camera.pmd", "run");
  std::size_t sent = 0;
  int bodies = 0;
  count("POSE_BODY", bodies);
  const auto send = [&] {
    if (sent == frames().size()) return;
    ASSERT_TRUE(bus_->publish("OPENNI_FRAME", openni_frame(frames()[sent++])));
  };
  // A camera waits for nobody: it begins when everything is there.
  ASSERT_TRUE(sheriff->wait_for_output("frame_source started as process")) << sheriff->output();
  std::this_thread::sleep_for(1s);
  ASSERT_TRUE(wait_for([&] { return poses_ >= 4 && bodies >= 4; }, send)) << sheriff->output();
  stop(*sheriff);
  EXPECT_GE(saved_poses(), 4);
}

}  // namespace
}  // namespace eg
