#include "common/eval/render.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <opencv2/core.hpp>

#include "common/base/random.hpp"
#include "common/eval/rasterizer.hpp"
#include "common/geometry/so3.hpp"

namespace eg::eval {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Colour = std::array<std::uint8_t, 3>;

constexpr double kDegree = std::numbers::pi / 180.0;
const cv::Vec3f kRed(0, 0, 255), kBlue(255, 0, 0);

int count(const cv::Mat& image, const cv::Vec3b& colour) {
  cv::Mat mask;
  cv::inRange(image, colour, colour, mask);
  return cv::countNonZero(mask);
}

TEST(Rasterizer, TheNearerTriangleWinsInEitherOrder) {
  const std::array<RasterVertex, 3> near = {{{{0, 0}, 1, kRed}, {{20, 0}, 1, kRed}, {{0, 20}, 1, kRed}}};
  std::array<RasterVertex, 3> far = near;
  for (RasterVertex& vertex : far) vertex = {vertex.pixel, 2, kBlue};
  for (const bool near_first : {true, false}) {
    Rasterizer rasterizer({32, 32}, {255, 255, 255});
    rasterizer.draw(near_first ? near : far);
    rasterizer.draw(near_first ? far : near);
    EXPECT_EQ(count(rasterizer.image(), {0, 0, 255}), 231);  // 1 + 2 + ... + 21 pixel centres
    EXPECT_EQ(count(rasterizer.image(), {255, 0, 0}), 0);
  }
}

TEST(Rasterizer, ColoursAreInterpolated) {
  Rasterizer rasterizer({11, 11}, {0, 0, 0});
  rasterizer.draw({{{{0, 0}, 1, {0, 0, 0}}, {{10, 0}, 1, {100, 200, 50}}, {{0, 10}, 1, {0, 0, 0}}}});
  EXPECT_EQ(rasterizer.image().at<cv::Vec3b>(0, 5), cv::Vec3b(50, 100, 25));
}

TEST(Rasterizer, WhatIsOutsideOrDegenerateIsHarmless) {
  Rasterizer rasterizer({16, 16}, {255, 255, 255});
  rasterizer.draw({{{{-1e9, -1e9}, 1, kRed}, {{-1e8, -1e9}, 1, kRed}, {{-1e9, -1e8}, 1, kRed}}});
  rasterizer.draw({{{{100, 100}, 1, kRed}, {{200, 100}, 1, kRed}, {{100, 200}, 1, kRed}}});
  rasterizer.draw({{{{1, 1}, 1, kRed}, {{5, 5}, 1, kRed}, {{9, 9}, 1, kRed}}});
  const double nan = std::nan("");
  rasterizer.draw({{{{nan, 1}, 1, kRed}, {{5, nan}, 1, kRed}, {{9, 9}, nan, kRed}}});
  EXPECT_EQ(count(rasterizer.image(), {255, 255, 255}), 256);
  rasterizer.draw({{{{-1e4, -1e4}, 1, kRed}, {{3e4, -1e4}, 1, kRed}, {{-1e4, 3e4}, 1, kRed}}});
  EXPECT_EQ(count(rasterizer.image(), {0, 0, 255}), 256);
}

/// Floor, ceiling and one wall of a room, y down, with normals into the room.
struct Room {
  std::vector<Vector3f> vertices, normals;
  std::vector<Colour> colours;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  void add(const Vector3f& corner, const Vector3f& u, const Vector3f& v, const Vector3f& normal, const Colour& colour) {
    const auto base = static_cast<std::uint32_t>(vertices.size());
    for (const Vector3f& p : {corner, Vector3f(corner + u), Vector3f(corner + u + v), Vector3f(corner + v)}) {
      vertices.push_back(p);
      normals.push_back(normal);
      colours.push_back(colour);
    }
    triangles.push_back({base, base + 1, base + 2});
    triangles.push_back({base, base + 2, base + 3});
  }
  [[nodiscard]] ColouredSurface surface() const { return {{vertices, triangles}, normals, colours}; }
};

Room make_room() {
  Room room;
  room.add({-2, 1, -1}, {4, 0, 0}, {0, 0, 5}, {0, -1, 0}, {0, 200, 0});
  room.add({-2, -1.5, -1}, {4, 0, 0}, {0, 0, 5}, {0, 1, 0}, {200, 0, 0});
  room.add({-2, -1.5, 4}, {1, 0, 0}, {0, 2.5, 0}, {0, 0, -1}, {0, 0, 200});
  return room;
}

struct Channels {
  int red = 0, green = 0, blue = 0;
};

Channels pixels_of_colour(const cv::Mat& image) {
  Channels channels;
  for (const cv::Vec3b& p : cv::Mat3b(image)) {
    channels.red += p[2] > 80 && p[0] == 0 && p[1] == 0;
    channels.green += p[1] > 80 && p[0] == 0 && p[2] == 0;
    channels.blue += p[0] > 80 && p[1] == 0 && p[2] == 0;
  }
  return channels;
}

TEST(RenderScene, LooksThroughTheCeilingIntoTheRoom) {
  RenderOptions options;
  options.width = 320;
  options.height = 240;
  const cv::Mat image = render_scene(make_room().surface(), {}, {}, options);
  EXPECT_EQ(image.size(), cv::Size(320, 240));
  EXPECT_EQ(image.type(), CV_8UC3);
  const Channels seen = pixels_of_colour(image);
  EXPECT_EQ(seen.red, 0);
  EXPECT_GT(seen.green, 5000);
  EXPECT_GT(seen.blue, 300);
}

TEST(RenderScene, AMirroredWorldLooksTheSame) {
  const Room room = make_room();
  Room mirrored = room;
  for (Vector3f& v : mirrored.vertices) v.y() = -v.y();
  for (Vector3f& n : mirrored.normals) n.y() = -n.y();
  const cv::Mat a = render_scene(room.surface(), {}, {}, render_options_for(false));
  const cv::Mat b = render_scene(mirrored.surface(), {}, {}, render_options_for(true));
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0.0);
}

TEST(RenderScene, DrawsPathsAndKeyframesOverIt) {
  const Room room = make_room();
  const Path path{"path", {{-1, 0, 0}, {1, 0, 3}}, cv::Scalar(200, 0, 200)};
  const std::vector<geometry::Pose> keyframes(1);
  const RenderOptions options;
  const cv::Mat without = render_scene(room.surface(), {}, {}, options);
  EXPECT_GT(cv::norm(without, render_scene(room.surface(), {&path, 1}, {}, options), cv::NORM_INF), 100.0);
  EXPECT_GT(cv::norm(without, render_scene(room.surface(), {}, keyframes, options), cv::NORM_INF), 50.0);
}

TEST(RefineUp, FindsTheFloorNearTheGuess) {
  Room room = make_room();
  const Eigen::Matrix3d tilt = geometry::so3_exp({25 * kDegree, 0, 10 * kDegree});
  for (Vector3f& v : room.vertices) v = (tilt * v.cast<double>()).cast<float>();
  const Vector3d up = refine_up(room.surface(), {0, -1, 0});
  EXPECT_LT(geometry::axial_angle(up, tilt.col(1)), 1e-3);
  EXPECT_LT(up.y(), 0.0);
}

TEST(RefineUp, KeepsTheGuessWithoutAFloor) {
  Room wall;
  wall.add({0, 0, 4}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {});
  EXPECT_EQ(refine_up(wall.surface(), {0, -2, 0}), Vector3d(0, -1, 0));
  EXPECT_EQ(refine_up({}, {0, 1, 0}), Vector3d(0, 1, 0));
}

TEST(BestAzimuth, LooksAtTheFrontOfAWall) {
  for (const double angle : {0.0, 1.0, 2.5, -2.0}) {
    Room wall;
    wall.add({-1, -1, 4}, {2, 0, 0}, {0, 2, 0}, {0, 0, -1}, {});
    const Eigen::Matrix3d turn = geometry::so3_exp({0, -angle, 0});
    for (Vector3f& v : wall.vertices) v = (turn * v.cast<double>()).cast<float>();
    for (Vector3f& n : wall.normals) n = (turn * n.cast<double>()).cast<float>();
    const RenderOptions options;
    const double difference = best_azimuth(wall.surface(), options) - angle;
    EXPECT_LT(std::abs(std::remainder(difference, 2 * std::numbers::pi)), 8 * kDegree);
  }
  EXPECT_EQ(best_azimuth({}, RenderOptions{}), RenderOptions{}.azimuth);
}

TEST(RenderOverview, AnyPartMayBeMissing) {
  const Room room = make_room();
  std::vector<geometry::StampedPose> estimate, reference;
  for (int i = 0; i < 20; ++i) {
    estimate.push_back({0.1 * i, {Eigen::Matrix3d::Identity(), {0.1 * i, 0.01 * i, 0.02 * i * i}}});
    reference.push_back({0.1 * i, {Eigen::Matrix3d::Identity(), {9 + 0.1 * i, 0.01 * i, 5 + 0.02 * i * i}}});
  }
  const RenderOptions options;
  EXPECT_EQ(render_overview({room.surface(), estimate, reference, {}}, options).size(), cv::Size(1280, 1280));
  EXPECT_EQ(render_overview({{}, estimate, {}, {}}, options).size(), cv::Size(1280, 320));
  EXPECT_EQ(render_overview({room.surface(), {}, reference, {}}, options).size(), cv::Size(1280, 1280));
  EXPECT_EQ(render_overview({}, options).size(), cv::Size(1280, 320));
}

}  // namespace
}  // namespace eg::eval
