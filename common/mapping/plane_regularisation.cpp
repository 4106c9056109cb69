#include "common/mapping/plane_regularisation.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "common/base/check.hpp"
#include "common/geometry/depth_noise.hpp"

namespace eg::mapping {
namespace {

constexpr int kCell = 8;            // pixels: 64 readings tell a mean to an eighth of the noise of one
constexpr float kMinReadings = 16;  // of a cell: fewer do not tell
constexpr float kMaxMean = 1.0F;    // of a cell's errors, in the plane's noise: rounded disparities err by 0.6 together
constexpr float kMaxError = 1.5F;   // rms of a cell's errors, in the plane's noise
constexpr float kMaxReading = 3.0F;    // error of one reading, in the plane's noise
constexpr float kMaxNoise = 1.0F;      // of a plane, sigma: what is rougher is no plane
constexpr double kLateralSigma = 0.8;  // pixels; the sensor's noise sideways (Nguyen, Izadi, Lovell, 3DIMPVT 2012)

/// What one row of the image should show of a plane.
class ExpectedRow {
 public:
  ExpectedRow(const PlaneInImage& plane, int row)
      : slope_(static_cast<float>(plane.coefficients.x())),
        offset_(static_cast<float>(plane.inverse_depth(0.0, row))),
        lateral_(static_cast<float>(plane.coefficients.head<2>().squaredNorm() * kLateralSigma * kLateralSigma)) {}

  [[nodiscard]] float inverse_depth(int column) const { return offset_ + slope_ * static_cast<float>(column); }

  /// Variance of a reading's inverse depth: sigma_w = w² sigma_z(1/w), and the noise sideways where depth slopes.
  [[nodiscard]] float variance(float inverse_depth) const {
    constexpr auto kFixed = static_cast<float>(geometry::kDepthSigmaFixed);
    constexpr auto kGrowth = static_cast<float>(geometry::kDepthSigmaGrowth);
    const float beyond = 1.0F - static_cast<float>(geometry::kDepthSigmaNearest) * inverse_depth;
    const float sigma = kFixed * inverse_depth * inverse_depth + kGrowth * beyond * beyond;
    return sigma * sigma + lateral_;
  }

 private:
  float slope_;
  float offset_;
  float lateral_;
};

/// 1/m; 0 where there is no reading.
cv::Mat invert(const cv::Mat& depth) {
  cv::Mat inverse(depth.size(), CV_32FC1);
  tbb::parallel_for(0, depth.rows, [&](int v) {
    const auto* const row = depth.ptr<float>(v);
    auto* const inverted = inverse.ptr<float>(v);
    for (int u = 0; u < depth.cols; ++u) {
      const bool is_reading = row[u] > 0.0F && row[u] <= std::numeric_limits<float>::max();  // false for NaN
      inverted[u] = is_reading ? 1.0F / row[u] : 0.0F;
    }
  });
  return inverse;
}

/// Sums over the readings of a cell, or over those of a column within a row of cells.
struct ErrorSums {
  float readings = 0;
  float errors = 0;   ///< in standard deviations of a reading
  float squares = 0;  ///< of the errors

  [[nodiscard]] bool is_enough() const { return readings >= kMinReadings; }
  [[nodiscard]] float mean_square() const { return squares / readings; }
};

struct CellGrid {
  explicit CellGrid(const cv::Mat& depth)
      : columns((depth.cols + kCell - 1) / kCell), rows((depth.rows + kCell - 1) / kCell) {}
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
  int columns;
  int rows;
};

/// A plane and how the image's cells fit it.
struct PlaneFitness {
  PlaneInImage plane;
  std::vector<ErrorSums> cells;
  float noise = 0;  ///< rms error of the median cell of the plane, sigma; 0: it is nowhere to be seen
};

/// Sums of the columns of pixels, as arrays and without branches, so that the compiler computes several at once.
class ColumnSums {
 public:
  explicit ColumnSums(int width)
      : scale_(static_cast<std::size_t>(width)),
        readings_(scale_.size()),
        errors_(scale_.size()),
        squares_(scale_.size()) {}

  void add_row(const float* inverse_depth, const ExpectedRow& expected, const PlaneInImage::Span& span) {
    set_scale(expected, span);
    float* const count = readings_.data();
    float* const sum = errors_.data();
    float* const sum_of_squares = squares_.data();
    for (int u = span.begin; u < span.end; ++u) {
      const float is_reading = inverse_depth[u] > 0.0F ? 1.0F : 0.0F;
      const float error =
          (inverse_depth[u] - expected.inverse_depth(u)) * scale_[static_cast<std::size_t>(u)] * is_reading;
      count[u] += is_reading;
      sum[u] += error;
      sum_of_squares[u] += error * error;
    }
  }

  /// Moves the sums to a row of cells.
  void move_to(ErrorSums* cells) {
    for (std::size_t u = 0; u < readings_.size(); ++u) {
      ErrorSums& cell = cells[u / kCell];
      cell.readings += std::exchange(readings_[u], 0.0F);
      cell.errors += std::exchange(errors_[u], 0.0F);
      cell.squares += std::exchange(squares_[u], 0.0F);
    }
  }

 private:
  /// One over the standard deviation of a reading, which is taken to be one within a cell.
  void set_scale(const ExpectedRow& expected, const PlaneInImage::Span& span) {
    for (int begin = span.begin; begin < span.end;) {
      const int end = std::min((begin / kCell + 1) * kCell, span.end);
      const float inverse_depth = expected.inverse_depth((begin + end) / 2);
      std::fill(scale_.begin() + begin, scale_.begin() + end, 1.0F / std::sqrt(expected.variance(inverse_depth)));
      begin = end;
    }
  }

  std::vector<float> scale_, readings_, errors_, squares_;
};

void measure_cells(const cv::Mat& inverse_depth, const CellGrid& grid, PlaneFitness& fitness) {
  fitness.cells.resize(grid.size());
  ColumnSums columns(inverse_depth.cols);
  const PlaneInImage& plane = fitness.plane;
  const int end = plane.first_row + static_cast<int>(plane.spans.size());
  for (int v = plane.first_row; v < end; ++v) {
    columns.add_row(inverse_depth.ptr<float>(v), ExpectedRow(plane, v), plane.span(v));
    if (v % kCell == kCell - 1 || v + 1 == end) columns.move_to(&fitness.cells[grid.index(0, v / kCell)]);
  }
}

/// The rms error of the plane's median cell. The hull also holds what is before the plane: the cells that fit best are
/// the plane's own, as many as it has readings in the image.
void measure_noise(PlaneFitness& fitness) {
  std::vector<std::pair<float, float>> cells;  // mean square, readings
  for (const ErrorSums& cell : fitness.cells) {
    if (cell.is_enough()) cells.emplace_back(cell.mean_square(), cell.readings);
  }
  std::sort(cells.begin(), cells.end());
  const double all = std::accumulate(cells.begin(), cells.end(), 0.0, [](double sum, const auto& cell) {
    return sum + static_cast<double>(cell.second);
  });
  const double own = std::min(all, fitness.plane.support);
  double readings = 0.0;
  for (const auto& [mean_square, count] : cells) {
    readings += static_cast<double>(count);
    if (2.0 * readings < own) continue;
    fitness.noise = std::min(std::sqrt(mean_square), kMaxNoise);
    return;
  }
}

bool shows(const ErrorSums& cell, float noise) {
  return cell.is_enough() && std::abs(cell.errors) <= kMaxMean * noise * cell.readings &&
         cell.mean_square() <= kMaxError * kMaxError * noise * noise;
}

/// The plane that a cell shows; null: none, or more than one surface.
const PlaneFitness* find_plane(const std::vector<PlaneFitness>& planes, std::size_t cell) {
  const PlaneFitness* best = nullptr;
  for (const PlaneFitness& plane : planes) {
    if (!shows(plane.cells[cell], plane.noise)) continue;
    if (best == nullptr || plane.cells[cell].mean_square() < best->cells[cell].mean_square()) best = &plane;
  }
  return best;
}

/// Fuses the readings of one row, from column `begin` to before `end`, with the plane.
void fuse(const PlaneFitness& fitness, int row, int begin, int end, const float* inverse_depth, float* depth) {
  const PlaneInImage::Span span = fitness.plane.span(row);
  const ExpectedRow expected(fitness.plane, row);
  const float noise = fitness.noise * fitness.noise;
  for (int u = std::max(begin, span.begin); u < std::min(end, span.end); ++u) {
    if (inverse_depth[u] == 0.0F) continue;
    const float on_plane = expected.inverse_depth(u);
    const float deviation = inverse_depth[u] - on_plane;
    const float of_reading = noise * expected.variance(on_plane);
    if (deviation * deviation > kMaxReading * kMaxReading * of_reading) continue;
    const auto of_plane = static_cast<float>(std::max(fitness.plane.variance(u, row), 0.0));
    const float sum = of_plane + of_reading;
    if (sum > 0.0F) depth[u] = 1.0F / (on_plane + deviation * of_plane / sum);
  }
}

}  // namespace

cv::Mat regularise_depth(const cv::Mat& depth, const geometry::CameraModel& camera,
                         const std::vector<DepthPlane>& planes) {
  EG_CHECK(depth.type() == CV_32FC1, "depth in metres is CV_32FC1");
  EG_CHECK(depth.cols == camera.width && depth.rows == camera.height, "the image has the camera's size");
  std::vector<PlaneFitness> seen;
  for (const DepthPlane& plane : planes) {
    if (auto in_image = project(plane, camera)) seen.push_back({*std::move(in_image), {}, 0.0F});
  }
  const CellGrid grid(depth);
  const cv::Mat inverse_depth = invert(depth);
  tbb::parallel_for(std::size_t{0}, seen.size(), [&](std::size_t i) {
    measure_cells(inverse_depth, grid, seen[i]);
    measure_noise(seen[i]);
  });
  std::erase_if(seen, [](const PlaneFitness& plane) { return plane.noise == 0.0F; });

  cv::Mat regularised = depth.clone();
  tbb::parallel_for(0, grid.rows, [&](int cell_row) {
    for (int cell_column = 0; cell_column < grid.columns; ++cell_column) {
      const PlaneFitness* const plane = find_plane(seen, grid.index(cell_column, cell_row));
      if (plane == nullptr) continue;
      const int bottom = std::min(kCell * (cell_row + 1), depth.rows);
      const int right = kCell * (cell_column + 1);
      for (int v = kCell * cell_row; v < bottom; ++v) {
        fuse(*plane, v, kCell * cell_column, right, inverse_depth.ptr<float>(v), regularised.ptr<float>(v));
      }
    }
  });
  return regularised;
}

}  // namespace eg::mapping
