#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "common/features/feature_extractor.hpp"
#include "common/image/rectifier.hpp"
#include "common/mapping/plane_regularisation.hpp"
#include "common/mapping/tsdf_map.hpp"
#include "common/synthetic/sequence.hpp"
#include "tests/support/slam_loop.hpp"

/// How true and how complete the mesh of a synthetic scene is, with true poses and with tracked ones. The map's world
/// is the first camera, so that no surface lies along the voxels; with depth as read, and regularised by the planes of
/// the frame. The counters are the result; of times only planes_ms, what regularising a frame took.
namespace eg::mapping {
namespace {

constexpr int kFrames = 300;
constexpr int kFrameStep = 15;
constexpr int kPixelStep = 8;
const std::array kScenes = {"room", "slanted", "corridor", "corner"};

struct View {
  int frame = 0;
  geometry::Pose first_from_camera;
};

std::vector<View> true_views(const synthetic::SyntheticSequence& sequence) {
  const geometry::Pose first_from_scene = sequence.world_from_camera(0).inverse();
  std::vector<View> views;
  for (int i = 0; i < sequence.size(); i += kFrameStep) {
    views.push_back({i, first_from_scene * sequence.world_from_camera(i)});
  }
  return views;
}

/// The keyframes of a tracked run, where local bundle adjustment left them.
std::vector<View> tracked_views(const synthetic::SyntheticSequence& sequence) {
  test::SlamLoop loop;
  features::FeatureExtractor extractor;
  image::Rectifier rectifier;
  for (int i = 0; i < sequence.size(); ++i) loop.step(extractor.extract(rectifier.rectify(sequence.frame(i))));
  std::vector<View> views;
  for (const tracking::MapKeyframe& keyframe : loop.tracker().map().keyframes()) {
    views.push_back({static_cast<int>(keyframe.features.header.sequence), keyframe.world_from_camera});
  }
  return views;
}

/// Depth regularised by the planes that the extractor finds, as the mapper does.
cv::Mat regularise(const image::RectifiedFrame& frame, features::PlaneExtractor& extractor, double& milliseconds) {
  std::vector<DepthPlane> planes;
  for (const features::PlaneFeature& plane : extractor.extract(frame.depth, frame.camera).planes) {
    planes.push_back({plane.plane, plane.covariance, static_cast<double>(plane.support), plane.hull});
  }
  const auto start = std::chrono::steady_clock::now();
  cv::Mat depth = regularise_depth(frame.depth, frame.camera, planes);
  milliseconds += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return depth;
}

using Cell = std::array<int, 3>;
Cell cell_of(const Eigen::Vector3d& point, double size) {
  const Eigen::Vector3i cell = (point / size).array().floor().cast<int>();
  return {cell.x(), cell.y(), cell.z()};
}

/// Of the vertices, to the nearest true surface, in increasing order.
std::vector<double> distances_of(const Mesh& mesh, const synthetic::SyntheticSequence& sequence) {
  const geometry::Pose scene_from_first = sequence.world_from_camera(0);
  std::vector<double> distances;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    distances.push_back(clearance(sequence.scene(), scene_from_first * vertex.cast<double>()));
  }
  std::sort(distances.begin(), distances.end());
  return distances;
}

/// Share of the points with a vertex within about two voxels: in a cell of one voxel beside theirs.
double share_near(const std::vector<Eigen::Vector3d>& points, const Mesh& mesh, double voxel_size) {
  std::set<Cell> cells;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    const Cell cell = cell_of(vertex.cast<double>(), voxel_size);
    for (int i = 0; i < 27; ++i) cells.insert({cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1});
  }
  const auto near = std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
    return cells.contains(cell_of(point, voxel_size));
  });
  return static_cast<double>(near) / static_cast<double>(points.size());
}

/// Edges with one triangle that lie in the planes x, y or z = (k + offset) tiles. In the borders between tiles
/// (offset 0) there may be as many as elsewhere, where what was seen happens to end.
int open_edges_in_planes(const Mesh& mesh, double tile_size, double offset) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++uses[std::minmax(triangle[i], triangle[(i + 1) % 3])];
  }
  const auto in_plane = [&](const Eigen::Vector3f& vertex, int axis, double plane) {
    return std::abs(vertex[axis] / tile_size - offset - plane) < 1e-4;
  };
  return static_cast<int>(std::count_if(uses.begin(), uses.end(), [&](const auto& use) {
    const auto& [edge, triangles] = use;
    if (triangles != 1) return false;
    const Eigen::Vector3f& a = mesh.vertices[edge.first];
    const Eigen::Vector3f& b = mesh.vertices[edge.second];
    for (int axis = 0; axis < 3; ++axis) {
      const double plane = std::round(a[axis] / tile_size - offset);
      if (in_plane(a, axis, plane) && in_plane(b, axis, plane)) return true;
    }
    return false;
  }));
}

/// True points, in the first camera's frame, of the readings that a view fuses.
void append_seen(const synthetic::SyntheticSequence& sequence, int index, const image::RectifiedFrame& frame,
                 const TsdfOptions& tsdf, std::vector<Eigen::Vector3d>& seen) {
  const geometry::Pose first_from_camera = sequence.world_from_camera(0).inverse() * sequence.world_from_camera(index);
  const synthetic::Rendering exact = sequence.render(index);
  for (int v = 0; v < frame.camera.height; v += kPixelStep) {
    for (int u = 0; u < frame.camera.width; u += kPixelStep) {
      const float reading = frame.depth.at<float>(v, u);
      const auto depth = static_cast<double>(exact.depth.at<float>(v, u));
      if (reading < tsdf.min_depth || reading > tsdf.max_depth || depth == 0.0) continue;
      seen.push_back(first_from_camera * frame.camera.unproject({u, v}, depth));
    }
  }
}

void report(benchmark::State& state, const TsdfMap& map, const synthetic::SyntheticSequence& sequence,
            const std::vector<Eigen::Vector3d>& seen) {
  const double voxel_size = map.options().voxel_size;
  const Mesh mesh = map.extract_mesh().value();
  const std::vector<double> distances = distances_of(mesh, sequence);
  const auto count = static_cast<double>(distances.size());
  const auto far = std::upper_bound(distances.begin(), distances.end(), std::max(0.03, 2 * voxel_size));
  state.counters["mean_mm"] = 1e3 * std::accumulate(distances.begin(), distances.end(), 0.0) / count;
  state.counters["p95_mm"] = 1e3 * distances[distances.size() * 95 / 100];
  state.counters["ghost_%"] = 100.0 * static_cast<double>(distances.end() - far) / count;
  state.counters["complete_%"] = 100.0 * share_near(seen, mesh, voxel_size);
  state.counters["open_at_borders"] = open_edges_in_planes(mesh, map.tile_size(), 0.0);
  state.counters["open_between"] = open_edges_in_planes(mesh, map.tile_size(), 0.5);
  state.counters["MB"] = static_cast<double>(map.memory_bytes()) / 1e6;
}

/// The same views for all maps of a scene: tracking takes the most time.
const std::vector<View>& views_of(const synthetic::SyntheticSequence& sequence, std::array<std::int64_t, 3> key) {
  static std::map<std::array<std::int64_t, 3>, std::vector<View>> known;
  const auto [views, is_new] = known.try_emplace(key);
  if (is_new) views->second = key[2] != 0 ? tracked_views(sequence) : true_views(sequence);
  return views->second;
}

/// Arguments: scene, voxel size in mm, whether the images are noisy, whether the poses are tracked, whether depth is
/// regularised by planes.
void mesh_of_scene(benchmark::State& state) {
  synthetic::SequenceOptions options;
  options.scene = kScenes[static_cast<std::size_t>(state.range(0))];
  options.frame_count = kFrames;
  if (state.range(2) != 0) options.noise = synthetic::NoiseOptions{};
  const auto sequence = synthetic::SyntheticSequence::make(options).value();
  const std::vector<View>& views = views_of(sequence, {state.range(0), state.range(2), state.range(3)});
  TsdfOptions tsdf;
  tsdf.voxel_size = static_cast<double>(state.range(1)) / 1000.0;
  for (auto _ : state) {
    TsdfMap map(tsdf);
    image::Rectifier rectifier;
    features::PlaneExtractor extractor;
    std::vector<Eigen::Vector3d> seen;
    double milliseconds = 0.0;
    for (const View& view : views) {
      image::RectifiedFrame frame = rectifier.rectify(sequence.frame(view.frame));
      if (state.range(4) != 0) frame.depth = regularise(frame, extractor, milliseconds);
      benchmark::DoNotOptimize(map.integrate(frame, view.first_from_camera));
      append_seen(sequence, view.frame, frame, tsdf, seen);
    }
    report(state, map, sequence, seen);
    state.counters["planes_ms"] = milliseconds / static_cast<double>(views.size());
  }
}
BENCHMARK(mesh_of_scene)
    ->ArgNames({"scene", "mm", "noise", "tracked", "planes"})
    ->ArgsProduct({{0, 1, 2, 3}, {20, 10}, {0, 1}, {0, 1}, {0, 1}})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace eg::mapping
