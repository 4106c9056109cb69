#include "common/geometry/camera_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace eg::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::HasSubstr;

TEST(CameraModel, ProjectsAndUnprojectsEveryKnownCamera) {
  for (const std::string& name : camera_names()) {
    const CameraModel camera = *find_camera(name);
    EXPECT_EQ(camera.name, name);
    EXPECT_TRUE(validate(camera).has_value()) << name;
    for (const Vector2d& pixel : {Vector2d(0, 0), Vector2d(639, 479), Vector2d(123.4, 56.7)}) {
      EXPECT_NEAR((camera.project(camera.unproject(pixel, 2.5)) - pixel).norm(), 0.0, 1e-10) << name;
      EXPECT_DOUBLE_EQ(camera.unproject(pixel, 2.5).z(), 2.5);
    }
  }
}

TEST(CameraModel, NegativeFyPutsTheYAxisUp) {
  const CameraModel icl = *find_camera("icl");
  EXPECT_LT(icl.fy, 0.0);
  EXPECT_LT(icl.project({0, 1, 2}).y(), icl.cy) << "up in space is up in the image";
  EXPECT_GT(icl.ray({icl.cx, 0}).y(), 0.0);
  EXPECT_NEAR(icl.project({0, 1, 2}).y(), 239.5 - 240.0, 1e-12);
}

TEST(CameraModel, ContainsTheImageUpToTheLastPixelsCentre) {
  const CameraModel camera = *find_camera("synthetic");
  EXPECT_TRUE(camera.contains({0, 0}));
  EXPECT_TRUE(camera.contains({639, 479}));
  EXPECT_FALSE(camera.contains({639.1, 479}));
  EXPECT_FALSE(camera.contains({-0.1, 0}));
  EXPECT_FALSE(camera.contains({std::numeric_limits<double>::quiet_NaN(), 0}));
}

TEST(CameraModel, KnowsWhichCamerasDistort) {
  EXPECT_TRUE(find_camera("tum_fr1")->has_distortion());
  EXPECT_TRUE(find_camera("tum_fr2")->has_distortion());
  EXPECT_FALSE(find_camera("tum_fr3")->has_distortion());
  EXPECT_FALSE(find_camera("nobody").has_value());
}

TEST(CameraModel, ValidationNamesTheField) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto error_after = [](auto change) {
    CameraModel camera = *find_camera("synthetic");
    change(camera);
    const base::Status status = validate(camera);
    return status ? std::string() : status.error().message;
  };
  EXPECT_EQ(error_after([](CameraModel&) {}), "");
  EXPECT_EQ(error_after([](CameraModel& c) { c.fy = -525; }), "") << "legal";
  EXPECT_THAT(error_after([](CameraModel& c) { c.width = 0; }), HasSubstr("width"));
  EXPECT_THAT(error_after([](CameraModel& c) { c.height = 100000; }), HasSubstr("height"));
  EXPECT_THAT(error_after([](CameraModel& c) { c.fx = -1; }), HasSubstr("fx"));
  EXPECT_THAT(error_after([](CameraModel& c) { c.fy = 0; }), HasSubstr("fy"));
  EXPECT_THAT(error_after([&](CameraModel& c) { c.cx = nan; }), HasSubstr("cx"));
  EXPECT_THAT(error_after([&](CameraModel& c) { c.distortion[3] = nan; }), HasSubstr("distortion"));
  EXPECT_THAT(error_after([](CameraModel& c) { c.depth_units_per_metre = 0; }), HasSubstr("depth_units_per_metre"));
  EXPECT_THAT(error_after([](CameraModel& c) { c.fps = 0; }), HasSubstr("fps"));
}

}  // namespace
}  // namespace eg::geometry
