#include <benchmark/benchmark.h>

#include "common/image/rectifier.hpp"
#include "common/mapping/tsdf_map.hpp"
#include "common/synthetic/sequence.hpp"

namespace eg::mapping {
namespace {

struct View {
  image::RectifiedFrame frame;
  geometry::Pose world_from_camera;
};

/// Every 30th frame of the synthetic room, 640 x 480, with sensor noise.
std::vector<View> views_of_room(int count) {
  synthetic::SequenceOptions options;
  options.noise = synthetic::NoiseOptions{};
  const auto sequence = synthetic::SyntheticSequence::make(options).value();
  image::Rectifier rectifier;
  std::vector<View> views;
  for (int i = 0; i < count && 30 * i < sequence.size(); ++i) {
    views.push_back({rectifier.rectify(sequence.frame(30 * i)), sequence.world_from_camera(30 * i)});
  }
  return views;
}

TsdfOptions options_of(const benchmark::State& state) {
  TsdfOptions options;
  options.voxel_size = static_cast<double>(state.range(0)) / 1000.0;
  options.max_depth = 5.0;
  return options;
}

void integrate_into_an_empty_map(benchmark::State& state) {
  const std::vector<View> views = views_of_room(1);
  for (auto _ : state) {
    TsdfMap map(options_of(state));
    benchmark::DoNotOptimize(map.integrate(views[0].frame, views[0].world_from_camera));
  }
}
BENCHMARK(integrate_into_an_empty_map)
    ->Arg(20)
    ->Arg(10)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void integrate_again(benchmark::State& state) {
  const std::vector<View> views = views_of_room(1);
  TsdfMap map(options_of(state));
  for (auto _ : state) {
    const auto summary = map.integrate(views[0].frame, views[0].world_from_camera);
    state.counters["leaves"] = static_cast<double>(summary->leaves);
    state.counters["voxels"] = static_cast<double>(summary->voxels);
  }
}
BENCHMARK(integrate_again)->Arg(20)->Arg(10)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void extract_mesh_of_ten_views(benchmark::State& state) {
  TsdfMap map(options_of(state));
  for (const View& view : views_of_room(10)) {
    if (!map.integrate(view.frame, view.world_from_camera)) state.SkipWithError("a view was refused");
  }
  std::size_t triangles = 0;
  for (auto _ : state) triangles = map.extract_mesh().value().triangles.size();
  state.counters["triangles"] = static_cast<double>(triangles);
  state.counters["MB"] = static_cast<double>(map.memory_bytes()) / 1e6;
}
BENCHMARK(extract_mesh_of_ten_views)
    ->Arg(20)
    ->Arg(10)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void extract_changed_tiles(benchmark::State& state) {
  const std::vector<View> views = views_of_room(1);
  TsdfMap map(options_of(state));
  if (!map.integrate(views[0].frame, views[0].world_from_camera)) state.SkipWithError("the view was refused");
  const std::vector<Eigen::Vector3i> tiles = map.take_changed_tiles();
  for (auto _ : state) {
    for (const Eigen::Vector3i& tile : tiles) benchmark::DoNotOptimize(map.extract_tile(tile).value());
  }
  state.counters["tiles"] = static_cast<double>(tiles.size());
}
BENCHMARK(extract_changed_tiles)
    ->Arg(20)
    ->Arg(10)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace eg::mapping
