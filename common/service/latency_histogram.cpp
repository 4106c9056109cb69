#include "common/service/latency_histogram.hpp"

#include <algorithm>
#include <cmath>

namespace eg::service {
namespace {

constexpr double kGrowth = 1.02;
constexpr double kSmallestMs = 1e-3;

}  // namespace

void LatencyHistogram::add(double milliseconds) {
  const double steps = std::log(std::max(milliseconds, kSmallestMs) / kSmallestMs) / std::log(kGrowth);
  const int bucket = static_cast<int>(std::clamp(steps, 0.0, static_cast<double>(kBuckets - 1)));
  ++counts_[static_cast<std::size_t>(bucket)];
  ++total_;
  max_ms_ = std::max(max_ms_, milliseconds);
}

double LatencyHistogram::percentile_ms(double fraction) const {
  const auto wanted = static_cast<std::int64_t>(std::ceil(fraction * static_cast<double>(total_)));
  std::int64_t seen = 0;
  for (int bucket = 0; bucket < kBuckets; ++bucket) {
    seen += counts_[static_cast<std::size_t>(bucket)];
    if (seen > 0 && seen >= wanted) return std::min(max_ms_, kSmallestMs * std::pow(kGrowth, bucket + 1));
  }
  return 0.0;
}

}  // namespace eg::service
