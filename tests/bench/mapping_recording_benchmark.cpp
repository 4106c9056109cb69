#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <optional>
#include <vector>

#include "common/eval/alignment.hpp"
#include "common/image/rectifier.hpp"
#include "common/io/camera_file.hpp"
#include "common/io/dataset.hpp"
#include "common/io/trajectory_file.hpp"
#include "common/mapping/tsdf_map.hpp"

/// What fusing a frame of a recording costs: every 20th one with its true pose, at 1 cm up to 5 m. EGRAPH_RECORDING
/// names the recording's folder. Times are of integrate() alone, without reading images.
namespace eg::mapping {
namespace {

constexpr int kFrameStep = 20;
constexpr double kMaxTimeDifference = 0.02;  // seconds between an image and its true pose

struct View {
  image::RectifiedFrame frame;
  geometry::Pose world_from_camera;
};

base::Result<std::vector<View>> views_of(const std::filesystem::path& folder) {
  const auto dataset = io::open_dataset(folder);
  if (!dataset) return tl::make_unexpected(dataset.error());
  const auto camera = io::resolve_camera(folder, std::nullopt);
  if (!camera) return tl::make_unexpected(camera.error());
  const auto truth = io::read_trajectory(dataset->ground_truth);
  if (!truth) return tl::make_unexpected(truth.error());
  image::Rectifier rectifier;
  std::vector<View> views;
  for (std::size_t i = 0; i < dataset->frames.size(); i += kFrameStep) {
    const geometry::StampedPose image{dataset->frames[i].time_s, {}};
    const auto pair = eval::match_by_time({&image, 1}, *truth, kMaxTimeDifference);
    if (pair.empty()) continue;
    const auto frame = io::read_frame(*dataset, i, camera->camera);
    if (!frame) return tl::make_unexpected(frame.error());
    views.push_back({rectifier.rectify(*frame), pair.front().reference});
  }
  return views;
}

void integrate_recording(benchmark::State& state) {
  const char* const folder = std::getenv("EGRAPH_RECORDING");
  if (folder == nullptr) return state.SkipWithError("EGRAPH_RECORDING names no recording");
  const auto views = views_of(folder);
  if (!views) return state.SkipWithError(views.error().message.c_str());
  TsdfOptions options;
  options.voxel_size = 0.01;
  double slowest_ms = 0.0;
  double leaves = 0.0;
  std::clock_t cpu = 0;
  double wall_ms = 0.0;
  std::int64_t frames = 0;
  for (auto _ : state) {
    TsdfMap map(options);
    for (const View& view : *views) {
      const std::clock_t cpu_start = std::clock();
      const auto start = std::chrono::steady_clock::now();
      const auto summary = map.integrate(view.frame, view.world_from_camera);
      const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
      cpu += std::clock() - cpu_start;
      wall_ms += taken.count();
      slowest_ms = std::max(slowest_ms, taken.count());
      leaves += summary->leaves;
      ++frames;
    }
    state.counters["map_MB"] = static_cast<double>(map.memory_bytes()) / 1e6;
    state.counters["map_leaves"] = static_cast<double>(map.leaf_count());
  }
  const auto count = static_cast<double>(frames);
  state.counters["frame_ms"] = wall_ms / count;
  state.counters["slowest_ms"] = slowest_ms;
  state.counters["frame_cpu_ms"] = 1e3 * static_cast<double>(cpu) / CLOCKS_PER_SEC / count;
  state.counters["frame_leaves"] = leaves / count;
}
BENCHMARK(integrate_recording)->Iterations(1)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace eg::mapping
