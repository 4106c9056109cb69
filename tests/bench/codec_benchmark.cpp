// Depth codecs compared on one VGA frame of the synthetic camera's noise: ours, Zstandard and zlib on the raw bytes
// (the latter as other LCM camera drivers send it), PNG. Counter `bytes`: size of the result.
#include <benchmark/benchmark.h>
#include <zlib.h>
#include <zstd.h>

#include <cmath>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "common/base/random.hpp"
#include "common/codec/colour_codec.hpp"
#include "common/codec/depth_codec.hpp"
#include "common/geometry/depth_noise.hpp"

namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr double kUnitsPerMetre = 5000.0;

/// A corner of a room with the noise of a structured-light camera, or a file named by the environment.
cv::Mat depth_image() {
  if (const char* file = std::getenv("EGRAPH_BENCH_DEPTH")) return cv::imread(file, cv::IMREAD_UNCHANGED);
  eg::base::Random random(1);
  cv::Mat depth(kHeight, kWidth, CV_16UC1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double z = 1.5 + std::abs(x - 250) * 0.003 + y * 0.001;
      const double noisy = z + eg::geometry::depth_sigma(z) * random.normal();
      depth.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(std::lround(kUnitsPerMetre * noisy));
    }
  }
  return depth;
}

cv::Mat colour_image() {
  if (const char* file = std::getenv("EGRAPH_BENCH_COLOUR")) return cv::imread(file, cv::IMREAD_COLOR);
  eg::base::Random random(2);
  cv::Mat colour(kHeight, kWidth, CV_8UC3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int grey = ((x / 40 + y / 40) % 2 == 0 ? 90 : 170) + random.index(8);
      colour.at<cv::Vec3b>(y, x) = cv::Vec3b::all(static_cast<std::uint8_t>(grey));
    }
  }
  return colour;
}

const cv::Mat& depth() {
  static const cv::Mat image = depth_image();
  return image;
}

const cv::Mat& colour() {
  static const cv::Mat image = colour_image();
  return image;
}

void report(benchmark::State& state, std::size_t bytes) { state.counters["bytes"] = static_cast<double>(bytes); }

void encode_depth_delta_zstd(benchmark::State& state) {
  std::vector<std::uint8_t> bytes;
  for (auto _ : state) bytes = eg::codec::encode_depth(depth());
  report(state, bytes.size());
}
BENCHMARK(encode_depth_delta_zstd)->Unit(benchmark::kMillisecond);

void decode_depth_delta_zstd(benchmark::State& state) {
  const auto bytes = eg::codec::encode_depth(depth());
  for (auto _ : state) benchmark::DoNotOptimize(eg::codec::decode_depth(bytes, depth().cols, depth().rows));
}
BENCHMARK(decode_depth_delta_zstd)->Unit(benchmark::kMillisecond);

void encode_depth_zstd(benchmark::State& state) {
  const std::size_t raw = 2 * depth().total();
  std::vector<std::uint8_t> bytes(ZSTD_compressBound(raw));
  std::size_t size = 0;
  for (auto _ : state) size = ZSTD_compress(bytes.data(), bytes.size(), depth().data, raw, 1);
  report(state, size);
}
BENCHMARK(encode_depth_zstd)->Unit(benchmark::kMillisecond);

void encode_depth_zlib(benchmark::State& state) {
  const uLong raw = 2 * depth().total();
  std::vector<std::uint8_t> bytes(compressBound(raw));
  uLongf size = 0;
  for (auto _ : state) {
    size = bytes.size();
    compress2(bytes.data(), &size, depth().data, raw, 1);
  }
  report(state, size);
}
BENCHMARK(encode_depth_zlib)->Unit(benchmark::kMillisecond);

void encode_depth_png(benchmark::State& state) {
  std::vector<std::uint8_t> bytes;
  for (auto _ : state) cv::imencode(".png", depth(), bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  report(state, bytes.size());
}
BENCHMARK(encode_depth_png)->Unit(benchmark::kMillisecond);

void encode_colour_jpeg(benchmark::State& state) {
  std::vector<std::uint8_t> bytes;
  const int quality = static_cast<int>(state.range(0));
  for (auto _ : state) bytes = eg::codec::encode_colour(colour(), eg::codec::ColourEncoding::jpeg, quality);
  report(state, bytes.size());
}
BENCHMARK(encode_colour_jpeg)->Arg(80)->Arg(90)->Arg(95)->Unit(benchmark::kMillisecond);

void encode_colour_png(benchmark::State& state) {
  std::vector<std::uint8_t> bytes;
  for (auto _ : state) bytes = eg::codec::encode_colour(colour(), eg::codec::ColourEncoding::png);
  report(state, bytes.size());
}
BENCHMARK(encode_colour_png)->Unit(benchmark::kMillisecond);

void decode_colour_jpeg(benchmark::State& state) {
  using eg::codec::ColourEncoding;
  const auto bytes = eg::codec::encode_colour(colour(), ColourEncoding::jpeg);
  for (auto _ : state) {
    benchmark::DoNotOptimize(eg::codec::decode_colour(bytes, ColourEncoding::jpeg, colour().cols, colour().rows));
  }
}
BENCHMARK(decode_colour_jpeg)->Unit(benchmark::kMillisecond);

}  // namespace
