#include "common/features/plane_noise.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace eg::features {
namespace {

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Neither clutter nor a perfect renderer carries the thresholds away.
double noise_within_blocks(const BlockGrid& grid) {
  constexpr double kLowest = 1.0 / 3.0;
  std::vector<double> errors;
  for (const PlaneFit& fit : grid.fits) {
    if (fit.valid) errors.push_back(fit.mean_squared_error);
  }
  return errors.empty() ? 1.0 : std::clamp(std::sqrt(median(errors)), kLowest, 1.0);
}

/// Mean squared error, sigma², of the means of size x size blocks from their common plane; none if not all are flat.
std::optional<double> squared_waviness(const BlockGrid& grid, const PlaneTolerance& tolerance, int column, int row,
                                       int size) {
  PlaneMoments sum;
  for (int r = row; r < row + size; ++r) {
    for (int c = column; c < column + size; ++c) {
      const auto block = static_cast<std::size_t>(r * grid.columns + c);
      if (!grid.fits[block].valid) return std::nullopt;
      sum += grid.moments[block];
    }
  }
  const PlaneFit fit = fit_plane(sum);
  if (!fit.valid) return std::nullopt;
  const double lateral_variance = tolerance.lateral_variance(fit.plane);
  double squares = 0;
  for (int r = row; r < row + size; ++r) {
    for (int c = column; c < column + size; ++c) {
      const PlaneMoments& block = grid.moments[static_cast<std::size_t>(r * grid.columns + c)];
      const double mean_error = block.score(fit.plane).z() / block.weight;
      squares += mean_error * mean_error / (block.pixels / block.weight + lateral_variance);
    }
  }
  return squares / (size * size - 3);
}

/// The median over windows side by side.
std::optional<double> median_squared_waviness(const BlockGrid& grid, const PlaneTolerance& tolerance, int size) {
  constexpr std::size_t kEnoughWindows = 8;
  std::vector<double> values;
  for (int row = 0; row + size <= grid.rows; row += size) {
    for (int column = 0; column + size <= grid.columns; column += size) {
      if (const auto value = squared_waviness(grid, tolerance, column, row, size)) values.push_back(*value);
    }
  }
  return values.size() < kEnoughWindows ? std::nullopt : std::optional(median(values));
}

}  // namespace

DepthErrors measure_depth_errors(const BlockGrid& grid, const PlaneTolerance& tolerance) {
  DepthErrors errors;
  errors.noise = noise_within_blocks(grid);
  const auto narrow = median_squared_waviness(grid, tolerance, 2);
  const auto wide = median_squared_waviness(grid, tolerance, 4);
  if (!narrow || !wide) return errors;
  constexpr double kLeastWaviness = 0.05;
  constexpr double kChance = 1.5;  // by how much two estimates of one variance may differ
  errors.waviness = std::clamp(std::sqrt(*wide), kLeastWaviness, 1.0);
  errors.warp = std::min(1.0, std::sqrt(std::max(0.0, *wide - kChance * *narrow)));
  return errors;
}

}  // namespace eg::features
