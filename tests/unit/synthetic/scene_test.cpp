#include "common/synthetic/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/synthetic/trajectory.hpp"

namespace eg::synthetic {
namespace {

using testing::HasSubstr;

TEST(Scene, UnknownNamesAreListedWithTheKnownOnes) {
  const auto scene = make_scene("castle", 1);
  ASSERT_FALSE(scene.has_value());
  EXPECT_THAT(scene.error().message, HasSubstr("castle"));
  EXPECT_THAT(scene.error().message, HasSubstr("corridor"));
}

TEST(Scene, TheSeedChangesThePaintNotTheGeometry) {
  const Scene a = *make_scene("room", 1);
  const Scene b = *make_scene("room", 2);
  const Scene again = *make_scene("room", 1);
  ASSERT_EQ(a.surfaces.size(), b.surfaces.size());
  bool paint_differs = false;
  for (std::size_t i = 0; i < a.surfaces.size(); ++i) {
    EXPECT_EQ(a.surfaces[i].origin, b.surfaces[i].origin);
    EXPECT_EQ(a.surfaces[i].outline, b.surfaces[i].outline);
    paint_differs = paint_differs || a.surfaces[i].material.seed != b.surfaces[i].material.seed;
    EXPECT_EQ(a.surfaces[i].material.seed, again.surfaces[i].material.seed);
  }
  EXPECT_TRUE(paint_differs);
}

class EveryScene : public testing::TestWithParam<std::string> {
 protected:
  Scene scene_ = *make_scene(GetParam(), 1);
};
INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, testing::ValuesIn(scene_names()),
                         [](const auto& instance) { return instance.param; });

TEST_P(EveryScene, HasSoundSurfaces) {
  for (const Surface& surface : scene_.surfaces) {
    EXPECT_NEAR(surface.axis_u.norm(), 1.0, 1e-12);
    EXPECT_NEAR(surface.axis_v.norm(), 1.0, 1e-12);
    EXPECT_NEAR(surface.axis_u.dot(surface.axis_v), 0.0, 1e-12);
    EXPECT_GT(surface.area(), 1e-6) << "the outline is counter-clockwise";
    EXPECT_LE(surface.outline.size(), Surface::kMaxCorners);
    for (const Eigen::Vector2d& corner : surface.outline) {
      EXPECT_TRUE(surface.contains(corner, 1e-9)) << "the outline is convex";
      EXPECT_NEAR(surface.plane().signed_distance(surface.point(corner)), 0.0, 1e-12);
      EXPECT_NEAR((surface.uv(surface.point(corner)) - corner).norm(), 0.0, 1e-12);
    }
  }
}

TEST_P(EveryScene, ItsTrajectoryStaysHalfAMetreFromEverything) {
  for (const std::string& name : {GetParam(), std::string("spin")}) {
    const Trajectory trajectory = *make_trajectory(name);
    for (double t = 0; t <= trajectory.duration_s; t += 0.1) {
      EXPECT_GE(clearance(scene_, trajectory.world_from_camera(t).translation), 0.5) << name << " at " << t;
    }
  }
}

TEST(Slanted, HasAtLeastFiveWallDirectionsOfWhichSomeLean) {
  const Scene scene = *make_scene("slanted", 1);
  std::vector<Eigen::Vector3d> directions;
  for (const Surface& surface : scene.surfaces) {
    const Eigen::Vector3d normal = surface.normal();
    if (surface.area() < 1.5 || std::abs(normal.z()) > 0.9) continue;
    const auto parallel = [&](const Eigen::Vector3d& d) { return std::abs(d.dot(normal)) > std::cos(0.1); };
    if (std::none_of(directions.begin(), directions.end(), parallel)) directions.push_back(normal);
  }
  EXPECT_GE(directions.size(), 5U);
  const auto leans = [](const Eigen::Vector3d& d) { return std::abs(d.z()) > 0.1; };
  EXPECT_GE(std::count_if(directions.begin(), directions.end(), leans), 2);
}

TEST(CastRay, MeetsTheNearestFrontOnly) {
  const Scene corner = *make_scene("corner", 1);  // floor z = 0, walls x = 1.8 and y = 1.8
  const auto hit = cast_ray(corner, {0.3, 0.2, 1.0}, {1, 0, 0}, 10.0);
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->distance, 1.5, 1e-12);
  EXPECT_FALSE(cast_ray(corner, {0.3, 0.2, 1.0}, {1, 0, 0}, 1.4).has_value());
  EXPECT_FALSE(cast_ray(corner, {0.3, 0.2, 1.0}, {-1, 0, 0}, 10.0).has_value()) << "that side is open";
  EXPECT_FALSE(cast_ray(corner, {0.3, 0.2, -1.0}, {0, 0, 1}, 10.0).has_value()) << "the floor from below";
}

TEST(Clearance, IsTheDistanceToTheNearestPoint) {
  const Scene corner = *make_scene("corner", 1);
  EXPECT_NEAR(clearance(corner, {0.0, 0.0, 0.7}), 0.7, 1e-12);
  EXPECT_NEAR(clearance(corner, {1.8 + 0.3, 1.8 + 0.4, -1.2}), 1.3, 1e-12) << "beyond the common corner";
}

}  // namespace
}  // namespace eg::synthetic
