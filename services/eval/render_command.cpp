#include <map>
#include <vector>

#include "common/eval/render.hpp"
#include "common/io/graph_json.hpp"
#include "common/io/image_file.hpp"
#include "common/io/ply.hpp"
#include "common/io/trajectory_file.hpp"
#include "services/eval/commands.hpp"

namespace eg::service {
namespace {

namespace fs = std::filesystem;

/// `read` of the file, or nothing if there is no file.
template <typename T>
base::Result<T> read_if_given(const fs::path& file, base::Result<T> (*read)(const fs::path&)) {
  return file.empty() ? T{} : read(file);
}

using Trajectory = std::vector<geometry::StampedPose>;
base::Result<Trajectory> read_poses(const fs::path& file) { return io::read_trajectory(file); }

std::vector<geometry::Pose> keyframe_poses(const egraph::GraphWithEdges& graph) {
  std::vector<geometry::Pose> poses;
  for (const egraph::KeyframeNode& keyframe : graph.keyframes) poses.push_back(keyframe.world_from_camera);
  return poses;
}

/// Fewer shared features are no covisibility edge for systems that work on it.
constexpr int kMinShared = 15;

/// Two graphs over the same keyframes.
struct GraphPicture {
  std::vector<Eigen::Vector3d> keyframes;
  eval::PlottedGraph extensibility{"E-Graph", {}, {60, 140, 20}};
  eval::PlottedGraph covisibility{"covisibility (15 shared features or more)", {}, {200, 90, 20}};
};

GraphPicture picture_of(const egraph::GraphWithEdges& graph) {
  GraphPicture picture;
  std::map<egraph::KeyframeId, std::size_t> index_of;
  for (const egraph::KeyframeNode& keyframe : graph.keyframes) {
    index_of[keyframe.id] = picture.keyframes.size();
    picture.keyframes.push_back(keyframe.world_from_camera.translation);
  }
  for (const egraph::Edge& edge : graph.edges) {
    picture.extensibility.edges.emplace_back(index_of.at(edge.first), index_of.at(edge.second));
  }
  for (const auto& edge : graph.covisibility) {
    if (edge.shared_features < kMinShared) continue;
    picture.covisibility.edges.emplace_back(index_of.at(edge.first), index_of.at(edge.second));
  }
  return picture;
}

}  // namespace

base::Result<Report> render_picture(const PictureFiles& files, bool y_up, const fs::path& out) {
  if (files.mesh.empty() && files.trajectory.empty()) return base::fail("render needs --mesh or --trajectory");
  const auto mesh = read_if_given<io::PlyData>(files.mesh, io::read_ply);
  if (!mesh) return tl::make_unexpected(mesh.error());
  const auto estimate = read_if_given<Trajectory>(files.trajectory, read_poses);
  if (!estimate) return tl::make_unexpected(estimate.error());
  const auto reference = read_if_given<Trajectory>(files.groundtruth, read_poses);
  if (!reference) return tl::make_unexpected(reference.error());
  const auto graph = read_if_given<egraph::GraphWithEdges>(files.graph, io::read_graph);
  if (!graph) return tl::make_unexpected(graph.error());

  const std::vector<geometry::Pose> keyframes = keyframe_poses(*graph);
  const eval::Overview overview{
      {{mesh->vertices, mesh->triangles}, mesh->normals, mesh->colours}, *estimate, *reference, keyframes};
  const cv::Mat image = eval::render_overview(overview, eval::render_options_for(y_up));
  if (const auto status = io::write_png(out, image); !status) return tl::make_unexpected(status.error());
  const std::string size = std::to_string(image.cols) + "x" + std::to_string(image.rows);
  return Report{out.string() + ": " + size + " picture of " + std::to_string(mesh->triangles.size()) + " triangles, " +
                    std::to_string(estimate->size()) + " poses and " + std::to_string(keyframes.size()) +
                    " keyframes\n",
                {{"picture", out.string()}, {"width", image.cols}, {"height", image.rows}}};
}

base::Result<Report> render_edges(const fs::path& graph_file, bool y_up, const fs::path& out) {
  const auto graph = io::read_graph(graph_file);
  if (!graph) return tl::make_unexpected(graph.error());
  const GraphPicture picture = picture_of(*graph);
  const std::vector<eval::PlottedGraph> graphs = {picture.extensibility, picture.covisibility};
  const cv::Mat image = eval::render_graphs(picture.keyframes, graphs, eval::render_options_for(y_up));
  if (const auto status = io::write_png(out, image); !status) return tl::make_unexpected(status.error());
  const std::size_t edges = picture.extensibility.edges.size();
  const std::size_t covisible = picture.covisibility.edges.size();
  return Report{out.string() + ": " + std::to_string(edges) + " edges of the E-Graph, " + std::to_string(covisible) +
                    " of covisibility\n",
                {{"picture", out.string()}, {"edges", edges}, {"covisibility_edges", covisible}}};
}

}  // namespace eg::service
