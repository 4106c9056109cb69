#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/image/rectifier.hpp"
#include "common/mapping/tsdf_map.hpp"
#include "common/synthetic/sequence.hpp"

/// What a frame costs in a map of 1 to 100 rooms, and in a dense grid of one room (Curless and Levoy as KinectFusion
/// has them: Newcombe et al., ISMAR 2011).
namespace eg::mapping {
namespace {

constexpr double kVoxelSize = 0.02;
constexpr double kRoomDistance = 20.0;  // metres between two rooms

struct View {
  image::RectifiedFrame frame;
  geometry::Pose world_from_camera;
};

View view_of_room() {
  synthetic::SequenceOptions options;
  options.noise = synthetic::NoiseOptions{};
  const auto sequence = synthetic::SyntheticSequence::make(options).value();
  image::Rectifier rectifier;
  return {rectifier.rectify(sequence.frame(0)), sequence.world_from_camera(0)};
}

geometry::Pose in_room(const View& view, int room) {
  geometry::Pose pose = view.world_from_camera;
  pose.translation += kRoomDistance * Eigen::Vector3d(room % 10, room / 10, 0);
  return pose;
}

TsdfMap map_of_rooms(const View& view, int rooms) {
  TsdfOptions options;
  options.voxel_size = kVoxelSize;
  TsdfMap map(options);
  for (int room = 0; room < rooms; ++room) benchmark::DoNotOptimize(map.integrate(view.frame, in_room(view, room)));
  map.take_changed_tiles();
  return map;
}

void integrate_into_rooms(benchmark::State& state) {
  const View view = view_of_room();
  TsdfMap map = map_of_rooms(view, static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(map.integrate(view.frame, view.world_from_camera));
  state.counters["leaves"] = static_cast<double>(map.leaf_count());
}
BENCHMARK(integrate_into_rooms)
    ->Arg(1)
    ->Arg(10)
    ->Arg(100)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void update_mesh_of_rooms(benchmark::State& state) {
  const View view = view_of_room();
  TsdfMap map = map_of_rooms(view, static_cast<int>(state.range(0)));
  for (auto _ : state) {
    state.PauseTiming();
    benchmark::DoNotOptimize(map.integrate(view.frame, view.world_from_camera));
    state.ResumeTiming();
    for (const Eigen::Vector3i& tile : map.take_changed_tiles())
      benchmark::DoNotOptimize(map.extract_tile(tile).value());
  }
}
BENCHMARK(update_mesh_of_rooms)
    ->Arg(1)
    ->Arg(10)
    ->Arg(100)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// 8 x 8 x 4 m around the camera, every voxel looked up in every frame: no blocks, no threads, nearest pixel.
class DenseGrid {
 public:
  explicit DenseGrid(const Eigen::Vector3d& centre) : low_(centre - 0.5 * kVoxelSize * kSide.cast<double>()) {
    const auto voxels = static_cast<std::size_t>(kSide.prod());
    distance_.resize(voxels);
    weight_.resize(voxels);
    colour_.resize(voxels, Eigen::Vector3f::Zero());
  }

  void integrate(const View& view, float truncation) {
    const geometry::Pose camera_from_world = view.world_from_camera.inverse();
    std::size_t voxel = 0;
    for (int x = 0; x < kSide.x(); ++x) {
      for (int y = 0; y < kSide.y(); ++y) {
        for (int z = 0; z < kSide.z(); ++z, ++voxel) {
          const Eigen::Vector3d point = camera_from_world * (low_ + kVoxelSize * Eigen::Vector3d(x, y, z)).eval();
          if (point.z() <= 0.0) continue;
          const Eigen::Vector2d pixel = view.frame.camera.project(point);
          if (!view.frame.camera.contains(pixel)) continue;
          const int u = static_cast<int>(pixel.x() + 0.5);
          const int v = static_cast<int>(pixel.y() + 0.5);
          const float depth = view.frame.depth.at<float>(v, u);
          const float distance = depth - static_cast<float>(point.z());
          if (depth == 0.0F || distance < -truncation) continue;
          add(voxel, std::min(distance, truncation), view.frame.colour.at<cv::Vec3b>(v, u));
        }
      }
    }
  }

 private:
  inline static const Eigen::Vector3i kSide{400, 400, 200};

  void add(std::size_t voxel, float distance, const cv::Vec3b& bgr) {
    const float share = 1.0F / (weight_[voxel] + 1.0F);
    distance_[voxel] += share * (distance - distance_[voxel]);
    colour_[voxel] += share * (Eigen::Vector3f(bgr[2], bgr[1], bgr[0]) - colour_[voxel]);
    weight_[voxel] += 1.0F;
  }

  Eigen::Vector3d low_;
  std::vector<float> distance_;
  std::vector<float> weight_;
  std::vector<Eigen::Vector3f> colour_;
};

void integrate_into_a_dense_grid(benchmark::State& state) {
  const View view = view_of_room();
  DenseGrid grid(view.world_from_camera.translation);
  for (auto _ : state) grid.integrate(view, 3 * static_cast<float>(kVoxelSize));
}
BENCHMARK(integrate_into_a_dense_grid)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace eg::mapping
