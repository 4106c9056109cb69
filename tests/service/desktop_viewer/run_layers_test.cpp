#include "services/desktop_viewer/run_layers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "common/geometry/so3.hpp"
#include "common/io/graph_json.hpp"
#include "common/io/trajectory_file.hpp"
#include "tests/support/temporary_folder.hpp"

/// What the window of egraph-desktop-viewer shows, without a window.
namespace eg::services {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Vector3f = Eigen::Vector3f;

std::vector<std::string> names_of(const std::vector<Layer>& layers) {
  std::vector<std::string> names;
  for (const Layer& layer : layers) names.push_back(layer.name);
  return names;
}

std::vector<geometry::StampedPose> curve(const geometry::Pose& world_from_start) {
  std::vector<geometry::StampedPose> poses;
  for (int i = 0; i < 40; ++i) {
    const geometry::Pose pose{geometry::so3_exp({0, 0.02 * i, 0}), {0.05 * i, 0.002 * i * i, 0.03 * i}};
    poses.push_back({i / 30.0, world_from_start * pose});
  }
  return poses;
}

class DesktopLayers : public testing::Test {
 protected:
  /// A floor 1 m below the camera, and the way over it; x right, y down, z ahead.
  DesktopLayers() {
    io::PlyData mesh;
    mesh.vertices = {{-2, 1, 0}, {2, 1, 0}, {2, 1, 4}, {-2, 1, 4}};
    mesh.normals.assign(4, -Vector3f::UnitY());
    mesh.colours.assign(4, {10, 20, 30});
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    io::PlyData map;
    map.vertices = {{0, 0, 2}, {-1, 1, 3}, {1, 1, 3}};
    map.colours.assign(3, {200, 200, 200});
    map.edges = {{1, 2}};
    egraph::GraphWithEdges graph;
    for (const auto& pose : curve({})) {
      if (graph.keyframes.size() == 3) break;
      egraph::KeyframeNode& keyframe = graph.keyframes.emplace_back();
      keyframe.id = {static_cast<std::int32_t>(graph.keyframes.size()) - 1};
      keyframe.world_from_camera = pose.world_from_camera;
    }
    graph.edges = {{{0}, {1}, {}}, {{0}, {2}, {}}};
    EXPECT_TRUE(io::write_ply(file("mesh.ply"), io::view_of(mesh)));
    EXPECT_TRUE(io::write_ply(file("map.ply"), io::view_of(map)));
    EXPECT_TRUE(io::write_trajectory(file("trajectory.txt"), curve({})));
    EXPECT_TRUE(io::write_trajectory(file("keyframes.txt"), std::vector{curve({}).front(), curve({}).back()}));
    EXPECT_TRUE(io::write_graph(file("egraph.json"), graph));
  }

  [[nodiscard]] std::filesystem::path file(const char* name) const { return folder_.path() / name; }
  [[nodiscard]] base::Result<std::vector<Layer>> read(bool y_up = false) const {
    return read_run({folder_.path(), {}, y_up});
  }
  static const Layer& find(const std::vector<Layer>& layers, const std::string& name) {
    const auto found = std::find_if(layers.begin(), layers.end(), [&](const Layer& l) { return l.name == name; });
    if (found == layers.end()) throw std::runtime_error("no layer " + name);
    return *found;
  }

  test::TemporaryFolder folder_;
};

TEST_F(DesktopLayers, AreMadeOfEverythingThatARunLeaves) {
  const geometry::Pose elsewhere{geometry::so3_exp({0.3, -0.2, 0.5}), {4, 5, 6}};
  ASSERT_TRUE(io::write_trajectory(file("groundtruth.txt"), curve(elsewhere)));
  const auto layers = read();
  ASSERT_TRUE(layers) << layers.error().message;
  EXPECT_THAT(names_of(*layers),
              ElementsAre("mesh", "points", "lines", "trajectory", "ground truth", "keyframes", "E-Graph"));
  for (const Layer& layer : *layers) EXPECT_EQ(layer.shape.colours.size(), layer.shape.vertices.size()) << layer.name;
  EXPECT_EQ(find(*layers, "mesh").shape.triangles.size(), 2u);
  EXPECT_EQ(find(*layers, "points").shape.vertices.size(), 1u);
  EXPECT_FALSE(find(*layers, "points").visible) << "the mesh is there";
  EXPECT_EQ(find(*layers, "lines").shape.edges.size(), 1u);
  EXPECT_EQ(find(*layers, "trajectory").shape.edges.size(), 39u);
  EXPECT_EQ(find(*layers, "keyframes").shape.edges.size(), 2u * 8u);
  EXPECT_EQ(find(*layers, "E-Graph").shape.edges.size(), 2u);

  // The true way lies on the estimated one, wherever its own world was.
  const auto& estimate = find(*layers, "trajectory").shape.vertices;
  const auto& truth = find(*layers, "ground truth").shape.vertices;
  ASSERT_EQ(truth.size(), estimate.size());
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_LT((truth[i] - estimate[i]).norm(), 1e-4F);
}

TEST_F(DesktopLayers, HaveUpAlongZAndTheOutsideOutside) {
  for (const bool mirrored : {false, true}) {
    const auto layers = read(mirrored);
    ASSERT_TRUE(layers) << layers.error().message;
    const io::PlyData& floor = find(*layers, "mesh").shape;
    for (const Vector3f& vertex : floor.vertices) {
      EXPECT_NEAR(vertex.z(), mirrored ? 1.0F : -1.0F, 1e-5F) << "y is up or down";
      EXPECT_NEAR(vertex.y(), vertex == floor.vertices[0] || vertex == floor.vertices[1] ? 0.0F : 4.0F, 1e-5F);
    }
    EXPECT_NEAR(floor.vertices[1].x(), 2.0F, 1e-5F) << "what is on the right stays there";
    // Corners go around counter-clockwise seen from outside, in the file and on the screen.
    const auto& [a, b, c] = floor.triangles[0];
    const Vector3f across = (floor.vertices[b] - floor.vertices[a]).cross(floor.vertices[c] - floor.vertices[a]);
    const Vector3f y_axis(0, 0, mirrored ? 1.0F : -1.0F);
    EXPECT_LT(across.dot(y_axis), 0.0F);
    EXPECT_NEAR(floor.normals[0].dot(y_axis), -1.0F, 1e-5F);
  }
}

TEST_F(DesktopLayers, LackWhatTheRunDidNotMake) {
  std::filesystem::remove(file("mesh.ply"));
  std::filesystem::remove(file("egraph.json"));
  const auto layers = read();
  ASSERT_TRUE(layers) << layers.error().message;
  EXPECT_THAT(names_of(*layers), ElementsAre("points", "lines", "trajectory", "keyframes"));
  EXPECT_TRUE(find(*layers, "points").visible && find(*layers, "points").in_view);
}

TEST_F(DesktopLayers, SayWhatIsWrongWithTheFiles) {
  const test::TemporaryFolder empty;
  EXPECT_THAT(read_run({empty.path(), {}, false}).error().message, HasSubstr("has no mesh.ply, map.ply"));
  EXPECT_THAT(read_run({folder_.path(), file("truth.txt"), false}).error().message, HasSubstr("truth.txt: no such"));

  std::vector<geometry::StampedPose> later = curve({});
  for (auto& pose : later) pose.time_s += 100.0;
  ASSERT_TRUE(io::write_trajectory(file("groundtruth.txt"), later));
  EXPECT_THAT(read().error().message, HasSubstr("groundtruth.txt: has fewer than 10 poses at times of trajectory.txt"));
  std::filesystem::remove(file("groundtruth.txt"));

  const std::string ply = "ply\nformat ascii 1.0\nelement vertex 1\n";
  folder_.write("mesh.ply", ply);
  EXPECT_THAT(read().error().message, HasSubstr("mesh.ply"));
}

}  // namespace
}  // namespace eg::services
