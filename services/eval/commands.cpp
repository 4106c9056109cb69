#include "services/eval/commands.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "common/eval/alignment.hpp"
#include "common/eval/report.hpp"
#include "common/io/camera_file.hpp"
#include "common/io/graph_json.hpp"
#include "common/io/ply.hpp"
#include "common/io/trajectory_file.hpp"
#include "services/eval/json_report.hpp"

namespace eg::service {
namespace {

namespace fs = std::filesystem;
using geometry::StampedPose;
using Trajectory = std::vector<StampedPose>;

template <typename Errors>
Report report_of(const Errors& errors) {
  return {eval::table_of(errors), json_of(errors)};
}

/// The failure of a comparison, with the files that were compared.
tl::unexpected<base::Error> incomparable(const fs::path& estimate, const fs::path& reference,
                                         const base::Error& error) {
  return base::fail(estimate.string() + " against " + reference.string() + ": " + error.message);
}

/// Keyframes in increasing time and the edges between them by index.
struct Keyframes {
  std::vector<StampedPose> poses;
  std::vector<eval::GraphEdge> edges;
};

Keyframes keyframes_of(egraph::GraphWithEdges graph) {
  std::stable_sort(graph.keyframes.begin(), graph.keyframes.end(),
                   [](const auto& a, const auto& b) { return a.utime < b.utime; });
  Keyframes result;
  std::map<egraph::KeyframeId, std::size_t> index_of;
  for (const egraph::KeyframeNode& keyframe : graph.keyframes) {
    index_of[keyframe.id] = result.poses.size();
    result.poses.push_back({static_cast<double>(keyframe.utime) / 1e6, keyframe.world_from_camera});
  }
  for (const egraph::Edge& edge : graph.edges)
    result.edges.push_back({index_of.at(edge.first), index_of.at(edge.second)});
  return result;
}

base::Result<geometry::Pose> alignment_of(const MeshAlignment& files) {
  const auto estimate = io::read_trajectory(files.estimate);
  if (!estimate) return tl::make_unexpected(estimate.error());
  const auto reference = io::read_trajectory(files.reference);
  if (!reference) return tl::make_unexpected(reference.error());
  const double max_difference_s = eval::TrajectoryErrorOptions{}.max_time_difference_s;
  const auto pairs = eval::match_by_time(*estimate, *reference, max_difference_s);
  if (pairs.empty()) return incomparable(files.estimate, files.reference, {"no poses have the same time"});
  return eval::align_positions(pairs);
}

/// Reads two trajectories and reports what `evaluate` finds between them.
base::Result<Report> compare(const fs::path& estimate_file, const fs::path& reference_file, const auto& evaluate) {
  const auto estimate = io::read_trajectory(estimate_file);
  if (!estimate) return tl::make_unexpected(estimate.error());
  const auto reference = io::read_trajectory(reference_file);
  if (!reference) return tl::make_unexpected(reference.error());
  const auto errors = evaluate(*estimate, *reference);
  if (!errors) return incomparable(estimate_file, reference_file, errors.error());
  return report_of(*errors);
}

eval::SurfaceView surface_of(const io::PlyData& data) { return {data.vertices, data.triangles}; }

}  // namespace

base::Result<Report> report_trajectory(const fs::path& estimate, const fs::path& reference) {
  return compare(estimate, reference,
                 [](const Trajectory& a, const Trajectory& b) { return eval::evaluate_trajectory(a, b); });
}

base::Result<Report> report_drift(const fs::path& estimate, const fs::path& reference) {
  return compare(estimate, reference,
                 [](const Trajectory& a, const Trajectory& b) { return eval::evaluate_drift(a, b); });
}

base::Result<Report> report_graph(const fs::path& graph_file, const fs::path& reference_file,
                                  const std::string& camera) {
  const auto graph = io::read_graph(graph_file);
  if (!graph) return tl::make_unexpected(graph.error());
  const auto reference = io::read_trajectory(reference_file);
  if (!reference) return tl::make_unexpected(reference.error());
  const auto model = io::read_camera(camera);
  if (!model) return tl::make_unexpected(model.error());
  const Keyframes keyframes = keyframes_of(*graph);
  eval::GraphErrorOptions options;
  options.camera = *model;
  const auto errors = eval::evaluate_graph(keyframes.poses, keyframes.edges, *reference, options);
  if (!errors) return incomparable(graph_file, reference_file, errors.error());
  return report_of(*errors);
}

base::Result<Report> report_mesh(const fs::path& mesh_file, const fs::path& reference_file,
                                 const std::optional<MeshAlignment>& alignment) {
  auto mesh = io::read_ply(mesh_file);
  if (!mesh) return tl::make_unexpected(mesh.error());
  const auto reference = io::read_ply(reference_file);
  if (!reference) return tl::make_unexpected(reference.error());
  if (alignment) {
    const auto reference_from_estimate = alignment_of(*alignment);
    if (!reference_from_estimate) return tl::make_unexpected(reference_from_estimate.error());
    for (Eigen::Vector3f& vertex : mesh->vertices) {
      vertex = (*reference_from_estimate * vertex.cast<double>().eval()).cast<float>();
    }
  }
  const auto errors = eval::evaluate_mesh(surface_of(*mesh), surface_of(*reference));
  if (!errors) return incomparable(mesh_file, reference_file, errors.error());
  return report_of(*errors);
}

}  // namespace eg::service
