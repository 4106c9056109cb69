#include "services/frame_source/live_source_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <bot_core/images_t.hpp>

#include "common/codec/colour_codec.hpp"
#include "common/messages/channels.hpp"
#include "tests/support/bus_peer.hpp"

namespace eg::services {
namespace {

namespace channels = messages::channels;
using testing::HasSubstr;

constexpr char kChannel[] = "OPENNI_FRAME";
constexpr int kWidth = 16;
constexpr int kHeight = 12;
constexpr std::int64_t kSession = 7;

TEST(BotImages, HaveTheFingerprintsOfLibbot2) {
  EXPECT_EQ(static_cast<std::uint64_t>(bot_core::images_t::getHash()), 0x20ba4f05e8f5e33aU);
  EXPECT_EQ(static_cast<std::uint64_t>(bot_core::image_t::getHash()), 0x14739ffe13d5f5f0U);
  EXPECT_EQ(static_cast<std::uint64_t>(bot_core::image_metadata_t::getHash()), 0x9a4b634d0577fb8eU);
}

cv::Mat depth_image() {
  cv::Mat depth(kHeight, kWidth, CV_16UC1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) depth.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(1000 + 20 * y + x);
  }
  return depth;
}

std::vector<std::uint8_t> bytes_of(const cv::Mat& image) { return {image.datastart, image.dataend}; }

std::vector<std::uint8_t> zipped(const std::vector<std::uint8_t>& plain) {
  uLongf size = compressBound(plain.size());
  std::vector<std::uint8_t> packed(size);
  EXPECT_EQ(compress(packed.data(), &size, plain.data(), plain.size()), Z_OK);
  packed.resize(size);
  return packed;
}

bot_core::image_t image(std::int32_t pixel_format, std::vector<std::uint8_t> data) {
  bot_core::image_t image{};
  image.width = kWidth;
  image.height = kHeight;
  image.pixelformat = pixel_format;
  image.size = static_cast<std::int32_t>(data.size());
  image.data = std::move(data);
  image.nmetadata = 1;
  image.metadata.resize(1);
  image.metadata[0].key = "exposure";
  image.metadata[0].n = 2;
  image.metadata[0].value = {1, 2};
  return image;
}

/// What the driver of an OpenNI2 camera sends.
bot_core::images_t frame(std::int64_t utime) {
  const cv::Mat grey(kHeight, kWidth, CV_8UC3, cv::Scalar::all(90));
  bot_core::images_t images{};
  images.utime = utime;
  images.n_images = 2;
  images.image_types = {0, 6};
  images.images = {image(messages::bot::kPixelFormatMjpeg, codec::encode_colour(grey, codec::ColourEncoding::jpeg)),
                   image(-2, zipped(bytes_of(depth_image())))};
  images.images[0].row_stride = 3 * kWidth;
  images.images[1].row_stride = 2 * kWidth;
  return images;
}

messages::Bytes encoded(const bot_core::images_t& images) {
  messages::Bytes bytes(static_cast<std::size_t>(images.getEncodedSize()));
  images.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

class LiveSource : public testing::Test {
 protected:
  void send(const messages::Bytes& bytes) {
    camera_.send_bytes(kChannel, bytes);
    deliver();
  }
  void deliver() {
    ASSERT_TRUE(bus_.handle(std::chrono::milliseconds(0)));
    camera_.handle();
  }
  std::string rejection() { return context_.status().status(0).last_rejection; }

  std::shared_ptr<transport::MemoryNetwork> network_ = std::make_shared<transport::MemoryNetwork>();
  transport::MemoryBus bus_{network_};
  test::BusPeer camera_{network_};
  service::ServiceContext context_{bus_, {}};
  LiveSourceService service_{context_, {kChannel, {"tiny", kWidth, kHeight, 20, 20, 7.5, 5.5, {}, 5000, 30}, kSession}};
  test::Inbox<image::RgbdFrame> frames_ = camera_.collect<image::RgbdFrame>(channels::kRgbd);
};

TEST_F(LiveSource, PublishesWhatTheCameraSees) {
  send(encoded(frame(1'000'000)));
  send(encoded(frame(1'033'000)));
  ASSERT_EQ(frames_->size(), 2U) << rejection();
  const image::RgbdFrame& second = frames_->back();
  EXPECT_EQ(second.header.session, kSession);
  EXPECT_EQ(second.header.sequence, 1);
  EXPECT_EQ(second.header.utime, 1'033'000);
  EXPECT_EQ(second.camera.depth_units_per_metre, 1000.0) << "the type says millimetres";
  EXPECT_EQ(bytes_of(second.depth), bytes_of(depth_image()));
  EXPECT_NEAR(second.colour.at<cv::Vec3b>(5, 5)[0], 90, 3);
}

TEST_F(LiveSource, TakesPlainImagesWithPaddedRows) {
  bot_core::images_t images = frame(1'000'000);
  images.image_types[1] = 4;
  constexpr int kStride = 2 * kWidth + 10;
  std::vector<std::uint8_t> padded(static_cast<std::size_t>(kStride * kHeight), 0xEE);
  const cv::Mat depth = depth_image();
  for (int y = 0; y < kHeight; ++y) std::copy_n(depth.ptr(y), 2 * kWidth, padded.begin() + y * kStride);
  images.images[1] = image(-2, padded);
  images.images[1].row_stride = kStride;
  std::vector<std::uint8_t> red(static_cast<std::size_t>(3 * kWidth * kHeight), 0);
  for (std::size_t i = 0; i < red.size(); i += 3) red[i] = 200;
  images.images[0] = image(messages::bot::kPixelFormatRgb, red);
  send(encoded(images));
  ASSERT_EQ(frames_->size(), 1U) << rejection();
  EXPECT_EQ(bytes_of(frames_->front().depth), bytes_of(depth));
  EXPECT_NEAR(frames_->front().colour.at<cv::Vec3b>(5, 5)[2], 200, 10) << "RGB, not BGR";
}

TEST_F(LiveSource, SaysWhatIsWrongWithImages) {
  const auto refused = [&](const bot_core::images_t& images) {
    send(encoded(images));
    EXPECT_TRUE(frames_->empty());
    return rejection();
  };
  bot_core::images_t images = frame(1);
  images.image_types[1] = 2;
  EXPECT_THAT(refused(images), HasSubstr("no depth image"));
  images = frame(1);
  images.images[0].width = kWidth + 1;
  EXPECT_THAT(refused(images), HasSubstr("16 x 12 pixels"));
  images = frame(1);
  images.images[1].data.resize(20);
  images.images[1].size = 20;
  EXPECT_THAT(refused(images), HasSubstr("does not unpack"));
  images = frame(1);
  images.images[0].pixelformat = 5;
  EXPECT_THAT(refused(images), HasSubstr("neither MJPEG nor RGB"));
  images = frame(1);
  images.images[0].data.resize(30);
  images.images[0].size = 30;
  EXPECT_THAT(refused(images), HasSubstr("colour"));
}

TEST_F(LiveSource, EveryMessageThatIsCutOffIsRefused) {
  const messages::Bytes whole = encoded(frame(1'000'000));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(messages::decode<messages::bot::Images>(messages::ByteView(whole).first(size))) << size;
  }
  messages::Bytes longer = whole;
  longer.push_back(0);
  EXPECT_FALSE(messages::decode<messages::bot::Images>(longer));
}

TEST_F(LiveSource, AFrameFromThePastIsLeftOut) {
  send(encoded(frame(1'000'000)));
  send(encoded(frame(1'000'000)));
  EXPECT_EQ(frames_->size(), 1U);
  EXPECT_THAT(rejection(), HasSubstr("utime"));
}

TEST_F(LiveSource, GoesOnBehindWhatTheTrackerHadFromTheSourceBefore) {
  send(encoded(frame(1'000'000)));
  camera_.send(channels::kAcknowledge, messages::Acknowledge{kSession, 500, "tracker"});
  camera_.send(channels::kAcknowledge, messages::Acknowledge{kSession, 20, "mapper"});
  camera_.send(channels::kAcknowledge, messages::Acknowledge{kSession + 1, 900, "tracker"});
  deliver();
  send(encoded(frame(1'033'000)));
  ASSERT_EQ(frames_->size(), 2U);
  EXPECT_EQ(frames_->back().header.sequence, 501);
}

TEST_F(LiveSource, SendsAFrameAgainToWhoAsks) {
  send(encoded(frame(1'000'000)));
  camera_.send(channels::kResend, messages::ResendRequest{kSession, channels::kRgbd, {0, 5}});
  deliver();
  for (int i = 0; i < 3; ++i) service_.idle(i);
  deliver();
  ASSERT_EQ(frames_->size(), 2U);
  EXPECT_EQ(frames_->back().header.sequence, 0);
}

}  // namespace
}  // namespace eg::services
