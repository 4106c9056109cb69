#include <benchmark/benchmark.h>

#include "common/synthetic/sequence.hpp"

namespace eg::synthetic {
namespace {

SyntheticSequence sequence_of(const char* scene, bool noise) {
  SequenceOptions options;
  options.scene = scene;
  if (noise) options.noise = NoiseOptions{};
  return *SyntheticSequence::make(options);
}

void make_sequence(benchmark::State& state, const char* scene) {
  for (auto _ : state) benchmark::DoNotOptimize(sequence_of(scene, false));
}
BENCHMARK_CAPTURE(make_sequence, room, "room")->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void render_frames(benchmark::State& state, const char* scene) {
  const SyntheticSequence sequence = sequence_of(scene, false);
  int index = 0;
  for (auto _ : state) benchmark::DoNotOptimize(sequence.render(index = (index + 37) % sequence.size()));
}
BENCHMARK_CAPTURE(render_frames, room, "room")->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK_CAPTURE(render_frames, slanted, "slanted")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK_CAPTURE(render_frames, corridor, "corridor")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK_CAPTURE(render_frames, corner, "corner")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void add_noise_to_frame(benchmark::State& state) {
  const image::RgbdFrame frame = sequence_of("room", false).frame(0);
  for (auto _ : state) benchmark::DoNotOptimize(add_noise(frame, {}, 1));
}
BENCHMARK(add_noise_to_frame)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace eg::synthetic
