#include "common/tracking/feature_grid.hpp"

#include <algorithm>

namespace eg::tracking {
namespace {

constexpr double kCellPixels = 20.0;

}  // namespace

FeatureGrid::FeatureGrid(const features::FrameFeatures& frame)
    : frame_(frame),
      columns_(static_cast<int>(frame.camera.width / kCellPixels) + 1),
      rows_(static_cast<int>(frame.camera.height / kCellPixels) + 1),
      cells_(static_cast<std::size_t>(columns_ * rows_)) {
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    const Eigen::Vector2d& pixel = frame.points[i].pixel;
    cells_[static_cast<std::size_t>(row(pixel.y()) * columns_ + column(pixel.x()))].push_back(
        static_cast<std::int32_t>(i));
  }
}

int FeatureGrid::column(double x) const { return std::clamp(static_cast<int>(x / kCellPixels), 0, columns_ - 1); }

int FeatureGrid::row(double y) const { return std::clamp(static_cast<int>(y / kCellPixels), 0, rows_ - 1); }

std::vector<std::int32_t> FeatureGrid::within(const Eigen::Vector2d& pixel, double radius) const {
  std::vector<std::int32_t> found;
  for (int r = row(pixel.y() - radius); r <= row(pixel.y() + radius); ++r) {
    for (int c = column(pixel.x() - radius); c <= column(pixel.x() + radius); ++c) {
      for (const std::int32_t i : cells_[static_cast<std::size_t>(r * columns_ + c)]) {
        if ((frame_.points[static_cast<std::size_t>(i)].pixel - pixel).norm() <= radius) found.push_back(i);
      }
    }
  }
  return found;
}

}  // namespace eg::tracking
