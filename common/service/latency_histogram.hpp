#pragma once

#include <array>
#include <cstdint>

namespace eg::service {

/// Percentiles of any number of latencies in constant memory: buckets that grow by 2 %, from 1 microsecond to 1000
/// seconds.
class LatencyHistogram {
 public:
  void add(double milliseconds);

  /// The latency that `fraction` (0 to 1) of the samples do not exceed, within 2 %; 0 without samples.
  [[nodiscard]] double percentile_ms(double fraction) const;

  /// The largest sample, exactly.
  [[nodiscard]] double max_ms() const { return max_ms_; }

 private:
  static constexpr int kBuckets = 1048;

  std::array<std::int64_t, kBuckets> counts_{};
  std::int64_t total_ = 0;
  double max_ms_ = 0.0;
};

}  // namespace eg::service
