#include "common/mapping/tsdf_map.hpp"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <limits>

#include "common/base/random.hpp"
#include "common/geometry/depth_noise.hpp"
#include "tests/unit/mapping/analytic_scene.hpp"
#include "tests/unit/mapping/mesh_checks.hpp"

namespace eg::mapping {
namespace {

const Eigen::Vector3d kOrigin = Eigen::Vector3d::Zero();

TsdfOptions coarse() {
  TsdfOptions options;
  options.voxel_size = 0.04;
  return options;
}

TsdfMap fuse(const AnalyticScene& scene, const geometry::CameraModel& camera, const std::vector<geometry::Pose>& poses,
             const TsdfOptions& options) {
  TsdfMap map(options);
  for (const geometry::Pose& pose : poses) EXPECT_TRUE(map.integrate(scene.render(camera, pose), pose));
  return map;
}

double voxels(const TsdfMap& map, double metres) { return metres / map.options().voxel_size; }

class TsdfMapOfBothHandsTest : public ::testing::TestWithParam<double> {};  // sign of fy

/// The whole inside of a room, over many leaf and tile borders: closed like a sphere, without seams, on the surface.
TEST_P(TsdfMapOfBothHandsTest, MakesARoomOneClosedSurface) {
  const AnalyticScene room = empty_room();
  geometry::CameraModel camera = square_camera(320, 120.0);
  camera.fy *= GetParam();
  const TsdfMap map = fuse(room, camera, views_all_round({0.1, 0.05, 0.2}), coarse());
  const Mesh mesh = map.extract_mesh().value();

  const EdgeReport edges = check_edges(mesh);
  EXPECT_EQ(edges.open, 0);
  EXPECT_EQ(edges.overused, 0);
  EXPECT_EQ(euler_characteristic(mesh), 2);
  EXPECT_GT(smallest_area(mesh), 0.0F);
  EXPECT_DOUBLE_EQ(share_facing_their_normals(mesh), 1.0);
  const SurfaceError error = surface_error(mesh, [&](const auto& point) { return room.distance(point); });
  EXPECT_LT(voxels(map, error.mean), 0.1);
  EXPECT_LT(voxels(map, error.max), 1.0);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) EXPECT_LT(mesh.normals[i].dot(mesh.vertices[i]), 0.0F);
}

INSTANTIATE_TEST_SUITE_P(SignOfFy, TsdfMapOfBothHandsTest, ::testing::Values(1.0, -1.0));

TEST(TsdfMapTest, PutsAnObliqueWallWhereItIs) {
  const AnalyticScene wall{{}, {{{-50, -50, 2.013}, {50, 50, 3}, false}}};
  for (const double yaw : {0.0, 0.4, 0.8}) {
    const TsdfMap map = fuse(wall, square_camera(300, 300.0), {pose_of(yaw, 0.1, kOrigin)}, {});
    const Mesh mesh = map.extract_mesh().value();
    ASSERT_GT(mesh.vertices.size(), 1000U) << yaw;
    const SurfaceError error = surface_error(mesh, [&](const auto& p) { return wall.distance(p); });
    EXPECT_LT(voxels(map, error.mean), 0.01) << yaw;
    EXPECT_LT(voxels(map, error.max), 0.3) << yaw;  // where the readings end, there is nothing to interpolate with
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    for (const Eigen::Vector3f& n : mesh.normals) normal += n;
    EXPECT_LT(normal.z() / static_cast<float>(mesh.normals.size()), -0.999F) << yaw;
  }
}

/// Cameras lose readings at grazing angles, here six of ten.
TEST(TsdfMapTest, MissingReadingsLeaveNoHolesInAGrazedFloor) {
  const AnalyticScene floor{{}, {{{-50, 0.613, -50}, {50, 2, 50}, false}}};
  const geometry::CameraModel camera = square_camera(300, 300.0);
  base::Random random(5);
  std::vector<geometry::Pose> poses;
  TsdfMap map;
  for (int i = 0; i < 12; ++i) {
    poses.push_back(pose_of(0.001 * i, -0.05, {0.003 * i, 0, 0}));
    image::RectifiedFrame frame = floor.render(camera, poses.back());
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        if (random.uniform() < 0.6) frame.depth.at<float>(v, u) = 0.0F;
      }
    }
    ASSERT_TRUE(map.integrate(frame, poses.back()));
  }
  const Mesh whole = fuse(floor, camera, poses, {}).extract_mesh().value();
  const Mesh mesh = map.extract_mesh().value();
  EXPECT_GT(static_cast<double>(mesh.triangles.size()), 0.97 * static_cast<double>(whole.triangles.size()));
  EXPECT_LT(voxels(map, surface_error(mesh, [&](const auto& p) { return floor.distance(p); }).mean), 0.1);
}

TEST(TsdfMapTest, MakesASphereRound) {
  const AnalyticScene scene{{{{0.03, -0.02, 1.6}, 0.5}}, {}};
  const TsdfMap map = fuse(scene, square_camera(400, 400.0), {pose_of(0, 0, kOrigin)}, {});
  const Mesh mesh = map.extract_mesh().value();
  const SurfaceError error = surface_error(mesh, [&](const auto& p) { return scene.distance(p); });
  EXPECT_LT(voxels(map, error.mean), 0.3);
  EXPECT_LT(voxels(map, error.max), 1.0);
  EXPECT_EQ(check_edges(mesh).overused, 0);
  EXPECT_GT(share_facing_their_normals(mesh), 0.999);
  // A ghost shell behind what is seen would double the area. The rim, seen at a grazing angle, is left out.
  double area = 0.0;
  for (const auto& triangle : mesh.triangles) area += area_vector(mesh, triangle).norm();
  const double seen = 2 * std::numbers::pi * 0.5 * 0.5 * (1 - 0.5 / 1.6);
  EXPECT_GT(area, 0.6 * seen);
  EXPECT_LT(area, seen);
}

TEST(TsdfMapTest, DoesNotSmearAcrossDepthEdges) {
  AnalyticScene scene = empty_room();
  scene.boxes.push_back({{-0.3, -0.2, 0.9}, {0.25, 0.4, 1.2}, false});
  std::vector<geometry::Pose> poses;
  for (int i = 0; i < 5; ++i) poses.push_back(pose_of(0.1 * i - 0.2, 0.05 * i, {0.2 - 0.1 * i, 0.05, -0.6}));
  const TsdfMap map = fuse(scene, square_camera(400, 300.0), poses, {});
  const Mesh mesh = map.extract_mesh().value();
  const SurfaceError error = surface_error(mesh, [&](const auto& p) { return scene.distance(p); });
  EXPECT_LT(voxels(map, error.mean), 0.1);
  EXPECT_LT(voxels(map, error.max), 0.3);
  EXPECT_EQ(check_edges(mesh).overused, 0);
}

TEST(TsdfMapTest, AveragesNoiseAway) {
  const AnalyticScene wall{{}, {{{-50, -50, 2.51}, {50, 50, 3}, false}}};
  const geometry::CameraModel camera = square_camera(200, 200.0);
  base::Random random(11);
  const auto mean_error = [&](int views) {
    TsdfMap map;
    for (int i = 0; i < views; ++i) {
      image::RectifiedFrame frame = wall.render(camera, {});
      for (auto z = frame.depth.begin<float>(); z != frame.depth.end<float>(); ++z) {
        *z += static_cast<float>(geometry::depth_sigma(*z) * random.normal());
      }
      EXPECT_TRUE(map.integrate(frame, {}));
    }
    return surface_error(map.extract_mesh().value(), [&](const auto& p) { return wall.distance(p); }).mean;
  };
  const double once = mean_error(1);
  const double often = mean_error(16);
  EXPECT_LT(once, geometry::depth_sigma(2.51));
  EXPECT_LT(often, 0.4 * once);
}

TEST(TsdfMapTest, InterpolatesColours) {
  const AnalyticScene wall{{}, {{{-50, -50, 1.5}, {50, 50, 3}, false}}};
  const geometry::CameraModel camera = square_camera(256, 256.0);
  const Mesh mesh = fuse(wall, camera, {{}}, {}).extract_mesh().value();
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector2d pixel = camera.project(mesh.vertices[i].cast<double>());
    EXPECT_NEAR(mesh.colours[i][0], 255 * pixel.x() / 256, 3);
    EXPECT_NEAR(mesh.colours[i][1], 255 * pixel.y() / 256, 3);
    EXPECT_EQ(mesh.colours[i][2], 40);
  }
}

TEST(TsdfMapTest, DoesNotDependOnThreadsOrOrder) {
  const AnalyticScene room = empty_room();
  const geometry::CameraModel camera = square_camera(160, 80.0);
  std::vector<geometry::Pose> poses = views_all_round({0.1, 0.05, 0.2});
  const Mesh reference = fuse(room, camera, poses, coarse()).extract_mesh().value();
  std::reverse(poses.begin(), poses.end());
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_TRUE(is_same(fuse(room, camera, poses, coarse()).extract_mesh().value(), reference))
        << threads << " threads";
  }
}

TEST(TsdfMapTest, TakesAFrameBackToTheLastBit) {
  const AnalyticScene room = empty_room();
  const geometry::CameraModel camera = square_camera(200, 100.0);
  const auto poses = views_all_round({0.1, 0.05, 0.2});
  TsdfMap map = fuse(room, camera, {poses[0], poses[1]}, coarse());
  const Mesh before = map.extract_mesh().value();
  const std::int64_t leaves_before = map.leaf_count();

  const image::RectifiedFrame frame = room.render(camera, poses[2]);
  const auto added = map.integrate(frame, poses[2]);
  ASSERT_TRUE(added);
  EXPECT_GT(map.leaf_count(), leaves_before);
  const auto taken = map.deintegrate(frame, poses[2]);
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->voxels, added->voxels);
  EXPECT_EQ(map.leaf_count(), leaves_before);
  EXPECT_TRUE(is_same(map.extract_mesh().value(), before));

  for (const auto& pose : {poses[1], poses[0]}) EXPECT_TRUE(map.deintegrate(room.render(camera, pose), pose));
  EXPECT_EQ(map.leaf_count(), 0);
  EXPECT_TRUE(map.extract_mesh().value().vertices.empty());
}

TEST(TsdfMapTest, TakingBackWhatWasNeverAddedChangesNothing) {
  const AnalyticScene room = empty_room();
  const geometry::CameraModel camera = square_camera(100, 50.0);
  TsdfMap map(coarse());
  const auto taken = map.deintegrate(room.render(camera, {}), {});
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->leaves, 0);
  EXPECT_EQ(map.leaf_count(), 0);
}

TEST(TsdfMapTest, LeavesOutReadingsThatMeanNothing) {
  const geometry::CameraModel camera = square_camera(64, 64.0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float depth : {0.0F, nan, infinity, -infinity, -1.0F, 0.1F, 1e30F, 7.1F}) {
    TsdfMap map;
    const image::RectifiedFrame frame{
        {}, camera, cv::Mat(64, 64, CV_8UC3, cv::Scalar::all(9)), cv::Mat(64, 64, CV_32FC1, cv::Scalar(depth))};
    const auto summary = map.integrate(frame, {});
    ASSERT_TRUE(summary) << depth;
    EXPECT_EQ(summary->voxels, 0) << depth;
    EXPECT_EQ(map.leaf_count(), 0) << depth;
    EXPECT_TRUE(map.extract_mesh().value().triangles.empty()) << depth;
    EXPECT_TRUE(map.take_changed_tiles().empty()) << depth;
  }
}

TEST(TsdfMapTest, TakesImagesOfOnePixel) {
  TsdfMap map;
  const image::RectifiedFrame frame{
      {}, square_camera(1, 1.0), cv::Mat(1, 1, CV_8UC3, cv::Scalar::all(9)), cv::Mat(1, 1, CV_32FC1, cv::Scalar(1.0))};
  EXPECT_TRUE(map.integrate(frame, {}));
  EXPECT_TRUE(map.extract_mesh().value().triangles.empty());
}

TEST(TsdfMapTest, RefusesWhatIsNoFrame) {
  const image::RectifiedFrame good = empty_room().render(square_camera(40, 40.0), {});
  TsdfMap map;
  const auto expect_refused = [&](const image::RectifiedFrame& frame, const geometry::Pose& pose, const char* word) {
    const auto result = map.integrate(frame, pose);
    ASSERT_FALSE(result);
    EXPECT_NE(result.error().message.find(word), std::string::npos) << result.error().message;
    EXPECT_EQ(map.leaf_count(), 0);
  };
  image::RectifiedFrame bad = good;
  bad.depth = cv::Mat(30, 40, CV_32FC1, cv::Scalar(1.0));
  expect_refused(bad, {}, "depth");
  bad = good;
  bad.depth = cv::Mat(40, 40, CV_16UC1, cv::Scalar(1.0));
  expect_refused(bad, {}, "depth");
  bad = good;
  bad.colour = cv::Mat();
  expect_refused(bad, {}, "colour");
  geometry::Pose pose;
  pose.translation.x() = std::numeric_limits<double>::quiet_NaN();
  expect_refused(good, pose, "pose");
}

TEST(TsdfMapTest, SurvivesPosesFarAway) {
  TsdfMap map;
  const image::RectifiedFrame frame = empty_room().render(square_camera(40, 40.0), {});
  for (const double far : {1e3, 1e6, 1e12, 1e300}) {
    ASSERT_TRUE(map.integrate(frame, {Eigen::Matrix3d::Identity(), {far, -far, far}})) << far;
  }
}

TEST(TsdfMapTest, TilesMakeUpTheMeshAndOnlyChangedOnesChange) {
  const AnalyticScene room = empty_room();
  const geometry::CameraModel camera = square_camera(200, 150.0);
  const auto poses = views_all_round({0.1, 0.05, 0.2});
  TsdfMap map = fuse(room, camera, {poses[0]}, coarse());
  const std::vector<Eigen::Vector3i> first = map.take_changed_tiles();
  EXPECT_TRUE(map.take_changed_tiles().empty());
  std::vector<Mesh> before;
  std::size_t triangles = 0;
  for (const auto& tile : first) triangles += before.emplace_back(map.extract_tile(tile).value()).triangles.size();
  EXPECT_EQ(triangles, map.extract_mesh().value().triangles.size());

  ASSERT_TRUE(map.integrate(room.render(camera, poses[1]), poses[1]));
  const std::vector<Eigen::Vector3i> second = map.take_changed_tiles();
  int unchanged = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (std::find(second.begin(), second.end(), first[i]) != second.end()) continue;
    EXPECT_TRUE(is_same(map.extract_tile(first[i]).value(), before[i]));
    ++unchanged;
  }
  EXPECT_GT(unchanged, 0);
}

TEST(TsdfOptionsTest, RefusesValuesOutOfRangeByName) {
  EXPECT_TRUE(validate(TsdfOptions{}));
  TsdfOptions options;
  options.voxel_size = 0.0;
  EXPECT_NE(validate(options).error().message.find("voxel_size"), std::string::npos);
  options = {};
  options.max_depth = options.min_depth;
  EXPECT_NE(validate(options).error().message.find("max_depth"), std::string::npos);
  options = {};
  options.truncation_sigmas = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(validate(options).error().message.find("truncation_sigmas"), std::string::npos);
}

}  // namespace
}  // namespace eg::mapping
