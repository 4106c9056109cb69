#include "services/desktop_viewer/run_layers.hpp"

#include <map>
#include <string>
#include <utility>

#include "common/eval/alignment.hpp"
#include "common/eval/render.hpp"
#include "common/io/graph_json.hpp"
#include "common/io/trajectory_file.hpp"

namespace eg::services {
namespace {

namespace fs = std::filesystem;
using Trajectory = std::vector<geometry::StampedPose>;

constexpr mapping::Colour kMeshColour = {185, 165, 140};

constexpr std::size_t kFewestPairs = 10;     ///< a shorter piece of a trajectory aligns in many ways
constexpr double kMaxTimeDifference = 0.02;  // seconds

/// `read` of the file, or nothing if there is no file.
template <typename T>
base::Result<T> read_if_there(const fs::path& file, base::Result<T> (*read)(const fs::path&)) {
  return fs::exists(file) ? read(file) : T{};
}

base::Result<Trajectory> read_poses(const fs::path& file) { return io::read_trajectory(file); }

/// The part of the true trajectory in the estimate's time, moved rigidly to where the estimate is.
base::Result<Trajectory> aligned(const Trajectory& truth, const Trajectory& estimate, const fs::path& file) {
  if (truth.empty() || estimate.empty()) return Trajectory{};
  const auto pairs = eval::match_by_time(estimate, truth, kMaxTimeDifference);
  if (pairs.size() < kFewestPairs) {
    return base::fail(file.string() + ": has fewer than " + std::to_string(kFewestPairs) +
                      " poses at times of trajectory.txt: the ground truth of another recording?");
  }
  const geometry::Pose estimate_from_truth = eval::align_positions(pairs).inverse();
  Trajectory result;
  for (const geometry::StampedPose& pose : truth) {
    if (pose.time_s < estimate.front().time_s || pose.time_s > estimate.back().time_s) continue;
    result.push_back({pose.time_s, estimate_from_truth * pose.world_from_camera});
  }
  return result;
}

/// The vertices that no edge has.
io::PlyData points_of(const io::PlyData& map) {
  std::vector<bool> in_edge(map.vertices.size(), false);
  for (const auto& [first, second] : map.edges) in_edge[first] = in_edge[second] = true;
  io::PlyData points;
  for (std::size_t i = 0; i < map.vertices.size(); ++i) {
    if (in_edge[i]) continue;
    points.vertices.push_back(map.vertices[i]);
    if (!map.colours.empty()) points.colours.push_back(map.colours[i]);
  }
  return points;
}

io::PlyData edges_of(const egraph::GraphWithEdges& graph) {
  io::PlyData shape;
  std::map<egraph::KeyframeId, std::uint32_t> index_of;
  for (const egraph::KeyframeNode& keyframe : graph.keyframes) {
    index_of[keyframe.id] = static_cast<std::uint32_t>(shape.vertices.size());
    shape.vertices.push_back(keyframe.world_from_camera.translation.cast<float>());
  }
  for (const egraph::Edge& edge : graph.edges)
    shape.edges.push_back({index_of.at(edge.first), index_of.at(edge.second)});
  if (shape.edges.empty()) shape.vertices.clear();
  shape.colours.assign(shape.vertices.size(), kEdgeColour);
  return shape;
}

/// Layers of what is there, in the order in which they are added.
class Layers {
 public:
  explicit Layers(const Eigen::Matrix3f& display_from_world) : display_from_world_(display_from_world) {}

  void add(const char* name, io::PlyData shape, float width, bool visible = true, bool in_view = true) {
    if (shape.vertices.empty()) return;
    if (shape.colours.empty()) shape.colours.assign(shape.vertices.size(), kMeshColour);
    to_display(display_from_world_, shape);
    layers_.push_back({name, {}, std::move(shape), width, visible, in_view});
  }
  std::vector<Layer> take() { return std::move(layers_); }

 private:
  Eigen::Matrix3f display_from_world_;
  std::vector<Layer> layers_;
};

Eigen::Vector3d up_of(const io::PlyData& mesh, bool y_up) {
  const Eigen::Vector3d guess = eval::render_options_for(y_up).up;
  return eval::refine_up({{mesh.vertices, mesh.triangles}, mesh.normals, mesh.colours}, guess);
}

}  // namespace

base::Result<std::vector<Layer>> read_run(const RunFiles& files) {
  const fs::path& folder = files.folder;
  const fs::path truth_file = files.ground_truth.empty() ? folder / "groundtruth.txt" : files.ground_truth;
  if (!files.ground_truth.empty() && !fs::exists(truth_file)) return base::fail(truth_file.string() + ": no such file");
  auto mesh = read_if_there<io::PlyData>(folder / "mesh.ply", io::read_ply);
  if (!mesh) return tl::make_unexpected(mesh.error());
  auto map = read_if_there<io::PlyData>(folder / "map.ply", io::read_ply);
  if (!map) return tl::make_unexpected(map.error());
  const auto trajectory = read_if_there<Trajectory>(folder / "trajectory.txt", read_poses);
  if (!trajectory) return tl::make_unexpected(trajectory.error());
  const auto keyframes = read_if_there<Trajectory>(folder / "keyframes.txt", read_poses);
  if (!keyframes) return tl::make_unexpected(keyframes.error());
  const auto graph = read_if_there<egraph::GraphWithEdges>(folder / "egraph.json", io::read_graph);
  if (!graph) return tl::make_unexpected(graph.error());
  auto truth = read_if_there<Trajectory>(truth_file, read_poses);
  if (truth) truth = aligned(*truth, *trajectory, truth_file);
  if (!truth) return tl::make_unexpected(truth.error());

  Layers layers(display_from_world(up_of(*mesh, files.y_up), files.y_up));
  const bool has_mesh = !mesh->triangles.empty();
  layers.add("mesh", std::move(*mesh), 1.0F);
  layers.add("points", points_of(*map), 2.0F, !has_mesh, !has_mesh);
  if (!map->edges.empty()) layers.add("lines", std::move(*map), 2.0F, !has_mesh, false);
  layers.add("trajectory", path_shape(*trajectory, kTrajectoryColour), 3.0F);
  layers.add("ground truth", path_shape(*truth, kTruthColour), 2.0F);
  layers.add("keyframes", camera_shape(*keyframes, kKeyframeColour), 1.0F);
  layers.add("E-Graph", edges_of(*graph), 1.0F, false);
  std::vector<Layer> result = layers.take();
  if (result.empty()) {
    return base::fail(folder.string() + ": has no mesh.ply, map.ply, trajectory.txt, keyframes.txt or egraph.json: " +
                      "is it what egraph-run --out has written?");
  }
  return result;
}

}  // namespace eg::services
