#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace eg::eval {

/// What a set of errors (each at least 0) looks like. All zero if there are none.
struct ErrorStatistics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;  ///< lower median: the smallest value that half of the weight does not exceed
  double p95 = 0.0;     ///< the smallest value that 95 % of the weight does not exceed
  double max = 0.0;
};

/// Every error counts the same.
ErrorStatistics statistics_of(std::span<const double> errors);

/// An error that stands for `weight` (at least 0) of something, e.g. of surface.
struct WeightedError {
  double error = 0.0;
  double weight = 1.0;
};
ErrorStatistics statistics_of(std::vector<WeightedError> errors);

/// The share of the weight, in [0, 1], with an error of at most `limit`; 0 if there is no weight.
double share_within(std::span<const WeightedError> errors, double limit);

}  // namespace eg::eval
