#include "common/eval/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace eg::eval {
namespace {

double total_weight(std::span<const WeightedError> errors) {
  double total = 0.0;
  for (const WeightedError& e : errors) total += e.weight;
  return total;
}

/// The smallest error that `share` of the weight does not exceed; `sorted` by error.
double quantile(std::span<const WeightedError> sorted, double total, double share) {
  double below = 0.0;
  for (const WeightedError& e : sorted) {
    below += e.weight;
    // Sums in another order may miss the exact share by rounding.
    if (below >= share * total * (1.0 - 1e-12)) return e.error;
  }
  return sorted.back().error;
}

}  // namespace

ErrorStatistics statistics_of(std::span<const double> errors) {
  std::vector<WeightedError> weighted;
  for (const double error : errors) weighted.push_back({error, 1.0});
  return statistics_of(std::move(weighted));
}

ErrorStatistics statistics_of(std::vector<WeightedError> errors) {
  const double total = total_weight(errors);
  if (total <= 0.0) return {};
  std::stable_sort(errors.begin(), errors.end(),
                   [](const WeightedError& a, const WeightedError& b) { return a.error < b.error; });
  double sum = 0.0, sum_of_squares = 0.0;
  for (const auto& [error, weight] : errors) {
    sum += weight * error;
    sum_of_squares += weight * error * error;
  }
  return {errors.size(),
          std::sqrt(sum_of_squares / total),
          sum / total,
          quantile(errors, total, 0.5),
          quantile(errors, total, 0.95),
          errors.back().error};
}

double share_within(std::span<const WeightedError> errors, double limit) {
  const double total = total_weight(errors);
  if (total <= 0.0) return 0.0;
  double within = 0.0;
  for (const auto& [error, weight] : errors) within += error <= limit ? weight : 0.0;
  return within / total;
}

}  // namespace eg::eval
