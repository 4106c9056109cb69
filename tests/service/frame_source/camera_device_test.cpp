#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "common/messages/channels.hpp"
#include "services/frame_source/image_pairer.hpp"
#include "services/frame_source/live_source_service.hpp"
#include "services/frame_source/openni/openni_camera.hpp"
#include "tests/support/bus_peer.hpp"

namespace eg::services {
namespace {

namespace channels = messages::channels;
using messages::bot::ImageKind;
using messages::bot::Images;
using testing::HasSubstr;

constexpr int kWidth = 16;
constexpr int kHeight = 12;
constexpr std::int64_t kSession = 7;
constexpr std::int64_t kFramePeriod = 33'333;  // microseconds

Images::Image image(ImageKind kind) {
  const int pixel_bytes = kind == ImageKind::left ? 3 : 2;
  return {kind,
          kWidth,
          kHeight,
          pixel_bytes * kWidth,
          messages::bot::kPixelFormatRgb,
          messages::Bytes(static_cast<std::size_t>(pixel_bytes * kWidth * kHeight), 9)};
}

TEST(ImagePairer, PutsImagesOfOneMomentTogetherInWhicheverOrderTheyCome) {
  ImagePairer pairer(kFramePeriod / 2);
  EXPECT_FALSE(pairer.add(image(ImageKind::left), 1'000'000));
  const auto first = pairer.add(image(ImageKind::depth_mm), 1'004'000);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->utime, 1'000'000) << "the colour image's";
  ASSERT_EQ(first->images.size(), 2U);
  EXPECT_EQ(first->images[0].kind, ImageKind::left);
  EXPECT_EQ(first->images[1].kind, ImageKind::depth_mm);
  EXPECT_FALSE(pairer.add(image(ImageKind::depth_mm), 1'033'000));
  EXPECT_TRUE(pairer.add(image(ImageKind::left), 1'034'000));
}

TEST(ImagePairer, LeavesOutAnImageWhosePartnerWasLost) {
  ImagePairer pairer(kFramePeriod / 2);
  EXPECT_FALSE(pairer.add(image(ImageKind::left), 1'000'000));
  EXPECT_FALSE(pairer.add(image(ImageKind::depth_mm), 1'000'000 + kFramePeriod)) << "of the frame after";
  const auto pair = pairer.add(image(ImageKind::left), 1'000'000 + kFramePeriod);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->utime, 1'000'000 + kFramePeriod);
}

/// Gives a number of images at once, and is then unplugged.
class FakeCamera : public CameraDevice {
 public:
  explicit FakeCamera(int frames) : frames_(frames) {}

  base::Result<std::optional<Images>> read(std::chrono::milliseconds /*timeout*/) override {
    if (given_ == frames_) return base::fail("the fake camera was unplugged");
    ++given_;
    return std::optional(
        Images{1'000'000 + given_ * kFramePeriod, {image(ImageKind::left), image(ImageKind::depth_mm)}});
  }
  [[nodiscard]] std::string description() const override { return "fake"; }

 private:
  int frames_;
  int given_ = 0;
};

class DeviceSource : public testing::Test {
 protected:
  LiveSourceService make(std::unique_ptr<CameraDevice> device) {
    return {
        context_, {"camera", {"tiny", kWidth, kHeight, 20, 20, 7.5, 5.5, {}, 5000, 30}, kSession}, std::move(device)};
  }

  std::shared_ptr<transport::MemoryNetwork> network_ = std::make_shared<transport::MemoryNetwork>();
  transport::MemoryBus bus_{network_};
  test::BusPeer peer_{network_};
  service::ServiceContext context_{bus_, {}};
  test::Inbox<image::RgbdFrame> frames_ = peer_.collect<image::RgbdFrame>(channels::kRgbd);
};

TEST_F(DeviceSource, PublishesWhatTheDeviceSeesAndEndsWithItsError) {
  LiveSourceService service = make(std::make_unique<FakeCamera>(2));
  std::string error;
  for (std::int64_t round = 0; error.empty(); ++round) {
    try {
      service.idle(round);
    } catch (const std::runtime_error& thrown) {
      error = thrown.what();
    }
    std::this_thread::yield();
  }
  peer_.handle();
  EXPECT_EQ(error, "the fake camera was unplugged");
  ASSERT_EQ(frames_->size(), 2U) << context_.status().status(0).last_rejection;
  EXPECT_EQ(frames_->front().header.session, kSession);
  EXPECT_EQ(frames_->back().header.sequence, 1);
  EXPECT_EQ(frames_->back().header.utime, 1'000'000 + 2 * kFramePeriod);
}

TEST(OpenNi, ReadsTheDummyDeviceOfTheLibrary) {
  const geometry::CameraModel camera{"dummy", 320, 240, 285, 285, 159.5, 119.5, {}, 1000, 30};
  auto device = open_openni_camera("Dummy", camera);
  if (!device && device.error().message.find("built without OpenNI2") != std::string::npos) {
    GTEST_SKIP() << device.error().message;
  }
  ASSERT_TRUE(device) << device.error().message;
  EXPECT_THAT((*device)->description(), HasSubstr("320 x 240"));
  std::int64_t last_utime = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  for (int pairs = 0; pairs < 3;) {
    // It counts its streams' images one by one: on a busy machine the two may run apart.
    if (std::chrono::steady_clock::now() > end) GTEST_SKIP() << "the dummy's streams did not meet";
    const auto images = (*device)->read(std::chrono::milliseconds(2000));
    ASSERT_TRUE(images) << images.error().message;
    if (!images->has_value()) continue;
    ++pairs;
    EXPECT_TRUE(messages::bot::to_frame(**images, camera));
    EXPECT_GT((*images)->utime, last_utime);
    last_utime = (*images)->utime;
  }
}

TEST(OpenNi, SaysWhatIsWrongWithADevice) {
  const auto nowhere = open_openni_camera("/nowhere/recording.oni", *geometry::find_camera("icl"));
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().message, HasSubstr("camera '/nowhere/recording.oni'"));
  if (nowhere.error().message.find("built without OpenNI2") != std::string::npos)
    GTEST_SKIP() << nowhere.error().message;
  const auto too_large = open_openni_camera("Dummy", *geometry::find_camera("icl"));
  ASSERT_FALSE(too_large);
  EXPECT_THAT(too_large.error().message, HasSubstr("no mode of 640 x 480 pixels at 30 per second"));
}

}  // namespace
}  // namespace eg::services
