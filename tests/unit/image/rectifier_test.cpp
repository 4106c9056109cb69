#include "common/image/rectifier.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

namespace eg::image {
namespace {

/// Brown's distortion, written out from its definition; pixels.
Eigen::Vector2d distort(const geometry::CameraModel& camera, const Eigen::Vector2d& undistorted) {
  const auto& [k1, k2, p1, p2, k3] = camera.distortion;
  const Eigen::Vector3d ray = camera.ray(undistorted);
  const double x = ray.x(), y = ray.y(), r2 = x * x + y * y;
  const double radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  const double xd = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
  const double yd = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
  return {camera.fx * xd + camera.cx, camera.fy * yd + camera.cy};
}

/// A frame whose colour (blue: column, green: row, in quarters) and depth tell the pixel they were taken at.
RgbdFrame ramp_frame(const geometry::CameraModel& camera) {
  RgbdFrame frame;
  frame.header = {3, 5, 77};
  frame.camera = camera;
  frame.colour.create(camera.height, camera.width, CV_8UC3);
  frame.depth.create(camera.height, camera.width, CV_16UC1);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      frame.colour.at<cv::Vec3b>(y, x) = cv::Vec3b(cv::saturate_cast<uchar>(x / 4), cv::saturate_cast<uchar>(y / 4), 9);
      frame.depth.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(1000 + 10 * x + 20 * y);
    }
  }
  return frame;
}

TEST(Rectifier, WithoutDistortionOnlyTheUnitChanges) {
  const RgbdFrame frame = ramp_frame(*geometry::find_camera("icl"));
  Rectifier rectifier;
  const RectifiedFrame rectified = rectifier.rectify(frame);
  EXPECT_EQ(rectified.header.sequence, 5);
  EXPECT_EQ(rectified.header.session, 3);
  EXPECT_EQ(rectified.header.utime, 77);
  EXPECT_EQ(rectified.camera, frame.camera);
  EXPECT_EQ(rectified.depth.type(), CV_32FC1);
  EXPECT_FLOAT_EQ(rectified.depth.at<float>(10, 20), (1000.0F + 200.0F + 200.0F) / 5000.0F);
  EXPECT_EQ(cv::norm(rectified.colour, frame.colour), 0.0);
}

TEST(Rectifier, TakesEveryPixelFromWhereTheLensPutIt) {
  for (const char* name : {"tum_fr1", "tum_fr2"}) {
    const geometry::CameraModel camera = *geometry::find_camera(name);
    Rectifier rectifier;
    const RectifiedFrame rectified = rectifier.rectify(ramp_frame(camera));
    EXPECT_FALSE(rectified.camera.has_distortion());
    EXPECT_EQ(rectified.camera.fx, camera.fx);
    double largest_shift = 0.0;
    for (int y = 0; y < rectified.camera.height; y += 13) {
      for (int x = 0; x < rectified.camera.width; x += 17) {
        const Eigen::Vector2d straight = camera.project(rectified.camera.ray(Eigen::Vector2d(x, y)));
        const Eigen::Vector2d source = distort(camera, straight);
        largest_shift = std::max(largest_shift, (source - straight).norm());
        const auto colour = rectified.colour.at<cv::Vec3b>(y, x);
        EXPECT_NEAR(colour[0], source.x() / 4, 1.1);
        EXPECT_NEAR(colour[1], source.y() / 4, 1.1);
        // Depth is that of one pixel, at most half a pixel away on each axis: no mean over an edge.
        const double raw = rectified.depth.at<float>(y, x) * camera.depth_units_per_metre;
        EXPECT_NEAR(raw, 1000 + 10 * source.x() + 20 * source.y(), 0.51 * 30 + 0.01);
        EXPECT_NEAR(std::fmod(raw + 0.005, 10.0), 0.0, 0.02);
      }
    }
    EXPECT_GT(largest_shift, 5.0) << "the distortion is worth removing";
  }
}

TEST(Rectifier, CutsOffWhatTheLensDidNotSee) {
  geometry::CameraModel pincushion = *geometry::find_camera("synthetic");
  pincushion.distortion = {0.5, 0, 0, 0, 0};  // draws pixels from beyond the border
  for (const auto& camera : {*geometry::find_camera("tum_fr1"), *geometry::find_camera("tum_fr2"), pincushion}) {
    const RectifiedFrame rectified = Rectifier().rectify(ramp_frame(camera));
    EXPECT_EQ(rectified.colour.size(), cv::Size(rectified.camera.width, rectified.camera.height));
    EXPECT_EQ(rectified.depth.size(), rectified.colour.size());
    EXPECT_EQ(cv::countNonZero(rectified.depth), rectified.depth.size().area()) << "every pixel was seen";
    EXPECT_GT(rectified.depth.size().area(), 0.65 * camera.width * camera.height) << "and not more than needed is gone";
  }
}

TEST(Rectifier, KeepsTheSizeWhereNothingIsUnseenAndWhereALensCannotBe) {
  geometry::CameraModel camera = *geometry::find_camera("synthetic");
  for (const double k1 : {-0.2, 1e6}) {
    camera.distortion = {k1, 0, 0, 0, 0};
    const RectifiedFrame rectified = Rectifier().rectify(ramp_frame(camera));
    EXPECT_EQ(rectified.depth.size(), cv::Size(camera.width, camera.height)) << k1;
    EXPECT_EQ(rectified.camera.cx, camera.cx);
  }
}

TEST(Rectifier, FollowsAChangeOfCamera) {
  Rectifier rectifier;
  const geometry::CameraModel fr1 = *geometry::find_camera("tum_fr1");
  const geometry::CameraModel fr2 = *geometry::find_camera("tum_fr2");
  (void)rectifier.rectify(ramp_frame(fr1));
  const RectifiedFrame second = rectifier.rectify(ramp_frame(fr2));
  EXPECT_EQ(cv::norm(second.depth, Rectifier().rectify(ramp_frame(fr2)).depth), 0.0);
}

}  // namespace
}  // namespace eg::image
