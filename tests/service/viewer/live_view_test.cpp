#include "services/viewer/live_view.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/service/viewer/read_packet.hpp"

namespace eg::services {
namespace {

/// The size of what is drawn of a depth image.
cv::Size drawn_size(int width, int height) {
  const geometry::CameraModel camera{"any", width, height, 20, 20, 0, 0, {}, 1000, 30};
  const auto frame = messages::compress({{1, 0, 0},
                                         camera,
                                         cv::Mat(height, width, CV_8UC3, cv::Scalar::all(100)),
                                         cv::Mat(height, width, CV_16UC1, cv::Scalar(2000))});
  const tracking::PoseEstimate pose;
  const auto bytes = LiveView().packet({&frame, nullptr, &pose}, DirectionColours());
  const test::ReadPacket packet(std::string(bytes.begin(), bytes.end()));
  return cv::imdecode(packet.array<std::uint8_t>("depth"), cv::IMREAD_COLOR).size();
}

TEST(LiveView, DrawsDepthOfAnyShapeInASmallPicture) {
  EXPECT_EQ(drawn_size(640, 480), cv::Size(320, 240));
  EXPECT_EQ(drawn_size(480, 640), cv::Size(240, 320));
  EXPECT_EQ(drawn_size(2, 600), cv::Size(1, 320));
}

}  // namespace
}  // namespace eg::services
