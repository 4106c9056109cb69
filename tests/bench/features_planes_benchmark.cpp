// Time of plane extraction per frame, one thread.
#include <benchmark/benchmark.h>

#include <vector>

#include "common/features/plane_extraction.hpp"
#include "common/synthetic/sequence.hpp"

namespace {

using eg::synthetic::SequenceOptions;
using eg::synthetic::SyntheticSequence;

/// Every 30th frame of a scene under sensor noise, rectified.
std::vector<cv::Mat> depth_images(const std::string& scene, const eg::geometry::CameraModel& camera) {
  SequenceOptions options;
  options.scene = scene;
  options.camera = camera;
  options.noise = eg::synthetic::NoiseOptions{};
  const SyntheticSequence sequence = SyntheticSequence::make(options).value();
  constexpr int kFrames = 10;
  std::vector<cv::Mat> images(kFrames);
  for (int i = 0; i < kFrames; ++i) {
    sequence.frame(30 * i).depth.convertTo(images[static_cast<std::size_t>(i)], CV_32F,
                                           1.0 / camera.depth_units_per_metre);
  }
  return images;
}

void extract_planes_of_scene(benchmark::State& state, const std::string& scene) {
  const auto camera = *eg::geometry::find_camera("synthetic");
  const std::vector<cv::Mat> images = depth_images(scene, camera);
  eg::features::PlaneExtractor extractor;
  std::size_t next = 0;
  std::size_t planes = 0;
  for (auto _ : state) {
    planes += extractor.extract(images[next++ % images.size()], camera).planes.size();
  }
  state.counters["planes"] = benchmark::Counter(static_cast<double>(planes), benchmark::Counter::kAvgIterations);
}

BENCHMARK_CAPTURE(extract_planes_of_scene, room, "room")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(extract_planes_of_scene, slanted, "slanted")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(extract_planes_of_scene, corridor, "corridor")->Unit(benchmark::kMillisecond);

}  // namespace
