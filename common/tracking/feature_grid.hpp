#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/features/features.hpp"

namespace eg::tracking {

/// Point features in cells of the image, to find those near a pixel.
class FeatureGrid {
 public:
  explicit FeatureGrid(const features::FrameFeatures& frame);

  /// Indices of the points within `radius` pixels, in ascending order of their cells.
  [[nodiscard]] std::vector<std::int32_t> within(const Eigen::Vector2d& pixel, double radius) const;

 private:
  [[nodiscard]] int column(double x) const;
  [[nodiscard]] int row(double y) const;

  const features::FrameFeatures& frame_;
  int columns_;
  int rows_;
  std::vector<std::vector<std::int32_t>> cells_;
};

}  // namespace eg::tracking
