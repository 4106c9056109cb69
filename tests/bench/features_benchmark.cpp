#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "common/base/random.hpp"
#include "common/features/feature_extractor.hpp"
#include "common/features/line_detector.hpp"
#include "common/features/vanishing_linkage.hpp"
#include "common/features/vanishing_preferences.hpp"
#include "common/image/rectifier.hpp"
#include "common/synthetic/sequence.hpp"

namespace {

using namespace eg;

/// A frame of the synthetic room, 640x480, with the sensor's noise.
const image::RectifiedFrame& frame() {
  static const image::RectifiedFrame rectified =
      image::Rectifier().rectify(synthetic::SyntheticSequence::make({}).value().frame(40));
  return rectified;
}

const cv::Mat& grey() {
  static const cv::Mat image = [] {
    cv::Mat converted;
    cv::cvtColor(frame().colour, converted, cv::COLOR_BGR2GRAY);
    return converted;
  }();
  return image;
}

void points(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(features::extract_points(grey(), frame().depth));
}
BENCHMARK(points)->Unit(benchmark::kMillisecond);

void segments(benchmark::State& state) {
  features::LineDetectorOptions options;
  options.kind = static_cast<features::LineDetectorKind>(state.range(0));
  features::LineDetector detector(options);
  for (auto _ : state) benchmark::DoNotOptimize(detector.detect(grey()));
  state.SetLabel(options.kind == features::LineDetectorKind::lsd ? "lsd" : "edlines");
}
BENCHMARK(segments)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void lines(benchmark::State& state) {
  std::size_t count = 0;
  features::LineExtractor extractor;
  for (auto _ : state) count = extractor.extract(grey(), frame().depth, frame().camera).size();
  state.counters["lines"] = static_cast<double>(count);
}
BENCHMARK(lines)->Unit(benchmark::kMillisecond);

void line_lifting(benchmark::State& state) {
  const auto found = features::extract_lines(grey(), frame().depth, frame().camera);
  const features::LineLifterOptions options;
  for (auto _ : state) {
    for (const features::MeasuredLine& line : found) {
      benchmark::DoNotOptimize(features::lift_line(line.segment, frame().depth, frame().camera, options, 1));
    }
  }
}
BENCHMARK(line_lifting)->Unit(benchmark::kMillisecond);

void directions(benchmark::State& state) {
  auto found = features::extract_lines(grey(), frame().depth, frame().camera);
  for (auto _ : state) benchmark::DoNotOptimize(features::extract_line_directions(found, frame().camera));
}
BENCHMARK(directions)->Unit(benchmark::kMillisecond);

/// Segments in random places of the image: no structure, the most clusters.
void j_linkage(benchmark::State& state) {
  base::Random random(1);
  const geometry::CameraModel& camera = frame().camera;
  std::vector<features::DirectionalSegment> found;
  for (int i = 0; i < state.range(0); ++i) {
    const Eigen::Vector2d start(random.uniform(50, 590), random.uniform(50, 430));
    const Eigen::Vector2d span(random.uniform(-50, 50), random.uniform(-50, 50));
    found.push_back(features::directional({start, start + span}, camera));
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(features::j_linkage(features::preference_sets(found, camera, 500, 1.5, 1)));
  }
}
BENCHMARK(j_linkage)->Arg(100)->Arg(300)->Arg(500)->Unit(benchmark::kMillisecond);

void planes(benchmark::State& state) {
  features::PlaneExtractor extractor;
  for (auto _ : state) benchmark::DoNotOptimize(extractor.extract(frame().depth, frame().camera));
}
BENCHMARK(planes)->Unit(benchmark::kMillisecond);

void whole_frame(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(0)));
  features::FeatureExtractor extractor;
  for (auto _ : state) benchmark::DoNotOptimize(extractor.extract(frame()));
}
BENCHMARK(whole_frame)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
