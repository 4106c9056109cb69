#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/base/random.hpp"
#include "common/io/dataset.hpp"
#include "common/io/image_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::io {
namespace {

using testing::HasSubstr;

std::string encoded(const std::string& extension, const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, image, bytes);
  return {bytes.begin(), bytes.end()};
}

/// Noise compresses badly, so that the images have many bytes to be cut or broken at.
cv::Mat noise(int type, int width = 64, int height = 48) {
  base::Random random(3);
  cv::Mat image(height, width, type);
  for (std::size_t i = 0; i < image.total() * image.elemSize(); ++i) {
    image.data[i] = static_cast<std::uint8_t>(random.index(256));
  }
  return image;
}

class ReadFrame : public testing::Test {
 protected:
  ReadFrame() {
    camera_ = {"test", 64, 48, 50, -50, 31.5, 23.5, {}, 5000, 30};
    dataset_.folder = folder_.path();
    write_colour(encoded(".png", noise(CV_8UC3)));
    write_depth(encoded(".png", noise(CV_16UC1)));
    dataset_.frames = {{}, {2.5, 2500000, folder_.path() / "c", folder_.path() / "d"}};
  }
  void write_colour(const std::string& bytes) { folder_.write("c", bytes); }
  void write_depth(const std::string& bytes) { folder_.write("d", bytes); }
  std::string error() {
    const auto frame = read_frame(dataset_, 1, camera_);
    EXPECT_FALSE(frame.has_value());
    return frame ? "" : frame.error().message;
  }
  test::TemporaryFolder folder_;
  geometry::CameraModel camera_;
  Dataset dataset_;
};

bool same(const cv::Mat& a, const cv::Mat& b) { return a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0; }

TEST_F(ReadFrame, GivesPixelsHeaderAndCamera) {
  const auto frame = read_frame(dataset_, 1, camera_);
  ASSERT_TRUE(frame.has_value()) << frame.error().message;
  EXPECT_TRUE(same(frame->colour, noise(CV_8UC3)));
  EXPECT_TRUE(same(frame->depth, noise(CV_16UC1)));
  EXPECT_EQ(frame->header.sequence, 1);
  EXPECT_EQ(frame->header.utime, 2500000);
  EXPECT_EQ(frame->camera, camera_);
}

TEST_F(ReadFrame, ConvertsGreyAndDropsAlpha) {
  write_colour(encoded(".png", noise(CV_8UC1)));
  auto frame = read_frame(dataset_, 1, camera_);
  ASSERT_TRUE(frame.has_value()) << frame.error().message;
  cv::Mat grey;
  cv::cvtColor(frame->colour, grey, cv::COLOR_BGR2GRAY);
  EXPECT_TRUE(same(grey, noise(CV_8UC1)));

  write_colour(encoded(".png", noise(CV_8UC4)));
  frame = read_frame(dataset_, 1, camera_);
  ASSERT_TRUE(frame.has_value()) << frame.error().message;
  EXPECT_EQ(frame->colour.type(), CV_8UC3);
}

TEST_F(ReadFrame, RefusesOtherPixelTypes) {
  write_colour(encoded(".png", noise(CV_16UC3)));
  EXPECT_THAT(error(), HasSubstr("/c: colour image is 16-bit with 3 channels; it must be 8-bit"));
  write_colour(encoded(".jpg", noise(CV_8UC3)));
  write_depth(encoded(".png", noise(CV_8UC1)));
  EXPECT_THAT(error(), HasSubstr("/d: depth image is 8-bit with 1 channel; it must be 16-bit with 1 channel"));
  write_depth(encoded(".png", noise(CV_16UC3)));
  EXPECT_THAT(error(), HasSubstr("/d: depth image is 16-bit with 3 channels"));
}

TEST_F(ReadFrame, RefusesOtherSizes) {
  write_depth(encoded(".png", noise(CV_16UC1, 32, 24)));
  EXPECT_THAT(error(), HasSubstr("/d: image is 32x24, but camera 'test' is 64x48"));
  write_colour(encoded(".png", noise(CV_8UC3, 1, 1)));
  EXPECT_THAT(error(), HasSubstr("/c: image is 1x1, but camera 'test' is 64x48"));
}

TEST_F(ReadFrame, RefusesWhatIsMissingOrNoImage) {
  std::filesystem::remove(folder_.path() / "d");
  EXPECT_THAT(error(), HasSubstr("/d: cannot be read: No such file or directory"));
  write_depth("");
  EXPECT_THAT(error(), HasSubstr("/d: file is empty"));
  write_depth("P5 not a PNG");
  EXPECT_THAT(error(), HasSubstr("/d: file is neither PNG nor JPEG"));
}

TEST(ImageCheck, EveryTruncationOfAPngIsFound) {
  const std::string whole = encoded(".png", noise(CV_16UC1, 16, 12));
  EXPECT_TRUE(check_image_is_whole(whole).has_value());
  EXPECT_TRUE(check_image_is_whole(whole + "trailing").has_value());
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(check_image_is_whole(std::string_view(whole).substr(0, length)).has_value()) << length;
  }
}

TEST(ImageCheck, EveryBrokenByteOfAPngIsFound) {
  const std::string whole = encoded(".png", noise(CV_16UC1, 16, 12));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string broken = whole;
    broken[i] = static_cast<char>(broken[i] ^ 0x10);
    EXPECT_FALSE(check_image_is_whole(broken).has_value()) << i;
  }
}

TEST(ImageCheck, EveryTruncationOfAJpegIsFound) {
  const std::string whole = encoded(".jpg", noise(CV_8UC3));
  EXPECT_TRUE(check_image_is_whole(whole).has_value());
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(check_image_is_whole(std::string_view(whole).substr(0, length)).has_value()) << length;
  }
}

TEST(ImageCheck, ProgressiveJpegIsWhole) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", noise(CV_8UC3), bytes, {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 2});
  EXPECT_TRUE(check_image_is_whole({reinterpret_cast<const char*>(bytes.data()), bytes.size()}).has_value());
}

}  // namespace
}  // namespace eg::io
