#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "common/image/rectifier.hpp"
#include "common/mapping/tsdf_map.hpp"
#include "common/synthetic/sequence.hpp"

/// How true and how complete the mesh of a synthetic scene is, with true poses. Not a time: the counters are the
/// result.
namespace eg::mapping {
namespace {

constexpr int kFrameStep = 15;
constexpr int kPixelStep = 8;
const std::array kScenes = {"room", "slanted", "corridor", "corner"};

using Cell = std::array<int, 3>;
Cell cell_of(const Eigen::Vector3d& point, double size) {
  const Eigen::Vector3i cell = (point / size).array().floor().cast<int>();
  return {cell.x(), cell.y(), cell.z()};
}

/// Of the vertices, to the nearest true surface, in increasing order.
std::vector<double> distances_of(const Mesh& mesh, const synthetic::Scene& scene) {
  std::vector<double> distances;
  for (const Eigen::Vector3f& vertex : mesh.vertices) distances.push_back(clearance(scene, vertex.cast<double>()));
  std::sort(distances.begin(), distances.end());
  return distances;
}

/// Share of the points with a vertex within about two voxels: in a cell of two voxels beside theirs.
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

/// Arguments: scene, voxel size in mm, whether the images are noisy.
void mesh_of_scene(benchmark::State& state) {
  synthetic::SequenceOptions options;
  options.scene = kScenes[static_cast<std::size_t>(state.range(0))];
  options.frame_count = 300;
  if (state.range(2) != 0) options.noise = synthetic::NoiseOptions{};
  const auto sequence = synthetic::SyntheticSequence::make(options).value();
  TsdfOptions tsdf;
  tsdf.voxel_size = static_cast<double>(state.range(1)) / 1000.0;
  for (auto _ : state) {
    TsdfMap map(tsdf);
    image::Rectifier rectifier;
    std::vector<Eigen::Vector3d> seen;
    for (int i = 0; i < sequence.size(); i += kFrameStep) {
      const geometry::Pose world_from_camera = sequence.world_from_camera(i);
      const image::RectifiedFrame frame = rectifier.rectify(sequence.frame(i));
      benchmark::DoNotOptimize(map.integrate(frame, world_from_camera));
      const synthetic::Rendering exact = sequence.render(i);
      for (int v = 0; v < frame.camera.height; v += kPixelStep) {
        for (int u = 0; u < frame.camera.width; u += kPixelStep) {
          const float reading = frame.depth.at<float>(v, u);
          if (reading < tsdf.min_depth || reading > tsdf.max_depth || exact.depth.at<float>(v, u) == 0.0F) continue;
          seen.push_back(world_from_camera *
                         frame.camera.unproject({u, v}, static_cast<double>(exact.depth.at<float>(v, u))));
        }
      }
    }
    const Mesh mesh = map.extract_mesh();
    const std::vector<double> distances = distances_of(mesh, sequence.scene());
    const auto count = static_cast<double>(distances.size());
    double sum = 0.0;
    for (const double d : distances) sum += d;
    const auto far = std::upper_bound(distances.begin(), distances.end(), std::max(0.03, 2 * tsdf.voxel_size));
    state.counters["mean_mm"] = 1e3 * sum / count;
    state.counters["p95_mm"] = 1e3 * distances[distances.size() * 95 / 100];
    state.counters["ghost_%"] = 100.0 * static_cast<double>(distances.end() - far) / count;
    state.counters["complete_%"] = 100.0 * share_near(seen, mesh, tsdf.voxel_size);
    state.counters["MB"] = static_cast<double>(map.memory_bytes()) / 1e6;
  }
}
BENCHMARK(mesh_of_scene)
    ->ArgNames({"scene", "mm", "noise"})
    ->ArgsProduct({{0, 1, 2, 3}, {20, 10}, {0, 1}})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace eg::mapping
