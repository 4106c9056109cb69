#include "common/features/line_descriptor.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <opencv2/imgproc.hpp>

namespace eg::features {
namespace {

constexpr int kBands = 9;
constexpr int kBandWidth = 5;  // rows, one pixel apart
constexpr int kRows = kBands * kBandWidth;
constexpr int kSums = 4;          // gradient across: right, left; along: forwards, backwards
constexpr int kMaxStations = 32;  // samples along a row

using RowSums = std::array<std::array<float, kSums>, kRows>;
using BandStatistics = std::array<std::array<float, 2 * kSums>, kBands>;

/// Sums of the gradients in the segment's own frame along every row of the support region, weighted towards the segment
/// (the global Gaussian of the paper).
RowSums sum_rows(const GradientImages& gradients, const Segment& segment) {
  const Eigen::Vector2f unit = segment.unit().cast<float>();
  const Eigen::Vector2f normal = segment.normal().cast<float>();
  const int stations = std::clamp(static_cast<int>(segment.length() / 2.0), 8, kMaxStations);
  const Eigen::Vector2f step = (segment.end - segment.start).cast<float>() / static_cast<float>(stations);
  constexpr float kGlobalSigma = 0.5F * kRows;
  RowSums sums{};
  for (int row = 0; row < kRows; ++row) {
    const auto offset = static_cast<float>(row - kRows / 2);
    const float weight = std::exp(-0.5F * offset * offset / (kGlobalSigma * kGlobalSigma));
    Eigen::Vector2f pixel = segment.start.cast<float>() + 0.5F * step + offset * normal;
    auto& sum = sums[static_cast<std::size_t>(row)];
    for (int i = 0; i < stations; ++i, pixel += step) {
      const int x = std::clamp(cvRound(pixel.x()), 0, gradients.dx.cols - 1);
      const int y = std::clamp(cvRound(pixel.y()), 0, gradients.dx.rows - 1);
      const Eigen::Vector2f gradient(gradients.dx.ptr<std::int16_t>(y)[x], gradients.dy.ptr<std::int16_t>(y)[x]);
      const float across = normal.dot(gradient);
      const float along = unit.dot(gradient);
      sum[0] += std::max(across, 0.0F);
      sum[1] += std::max(-across, 0.0F);
      sum[2] += std::max(along, 0.0F);
      sum[3] += std::max(-along, 0.0F);
    }
    for (float& value : sum) value *= weight / static_cast<float>(stations);
  }
  return sums;
}

/// Mean and standard deviation over the rows of each band and of the bands beside it, the latter counting less the
/// farther they are (the local Gaussian of the paper).
BandStatistics band_statistics(const RowSums& sums) {
  constexpr float kLocalSigma = kBandWidth;
  BandStatistics statistics{};
  for (int band = 0; band < kBands; ++band) {
    const int first = std::max(0, (band - 1) * kBandWidth);
    const int last = std::min(kRows, (band + 2) * kBandWidth);
    const float centre = (static_cast<float>(band) + 0.5F) * kBandWidth - 0.5F;
    for (std::size_t k = 0; k < kSums; ++k) {
      float total = 0.0F;
      float mean = 0.0F;
      float square = 0.0F;
      for (int row = first; row < last; ++row) {
        const float distance = (static_cast<float>(row) - centre) / kLocalSigma;
        const float weight = std::exp(-0.5F * distance * distance);
        const float value = sums[static_cast<std::size_t>(row)][k];
        total += weight;
        mean += weight * value;
        square += weight * value * value;
      }
      mean /= total;
      statistics[static_cast<std::size_t>(band)][k] = mean;
      statistics[static_cast<std::size_t>(band)][kSums + k] = std::sqrt(std::max(0.0F, square / total - mean * mean));
    }
  }
  return statistics;
}

}  // namespace

void compute_gradients(const cv::Mat& grey, GradientImages& gradients) {
  cv::spatialGradient(grey, gradients.dx, gradients.dy);
}

Descriptor describe_segment(const GradientImages& gradients, const Segment& segment) {
  const BandStatistics statistics = band_statistics(sum_rows(gradients, segment));
  Descriptor descriptor{};
  std::size_t byte = 0;
  for (std::size_t a = 0; a < kBands; ++a) {
    for (std::size_t b = a + 1; b < kBands; ++b) {
      if (b - a == kBands - 1 || (b - a == kBands - 2) || (b - a == kBands - 3 && a == 0))
        continue;  // 36 - 4 = 32 pairs
      for (std::size_t k = 0; k < 2 * kSums; ++k) {
        if (statistics[a][k] > statistics[b][k]) descriptor[byte] |= static_cast<std::uint8_t>(1U << k);
      }
      ++byte;
    }
  }
  return descriptor;
}

int hamming_distance(const Descriptor& a, const Descriptor& b) {
  int distance = 0;
  for (std::size_t i = 0; i < a.size(); i += sizeof(std::uint64_t)) {
    std::uint64_t word_a = 0;
    std::uint64_t word_b = 0;
    std::memcpy(&word_a, a.data() + i, sizeof word_a);
    std::memcpy(&word_b, b.data() + i, sizeof word_b);
    distance += std::popcount(word_a ^ word_b);
  }
  return distance;
}

}  // namespace eg::features
