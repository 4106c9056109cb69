#include "common/tracking/spatial_index.hpp"

#include <cmath>

namespace eg::tracking {
namespace {

/// Edge of a cell, metres: about a third of the range of a structured-light camera.
constexpr double kCellSize = 2.0;
/// Beyond this range (metres) depth is too uncertain to expect a feature to be found again.
constexpr double kMaxRange = 8.0;

Eigen::Vector3d centre_of(const Cell& cell) {
  return kCellSize * (Eigen::Vector3d(cell[0], cell[1], cell[2]) + Eigen::Vector3d::Constant(0.5));
}

/// Whether a sphere around the cell's centre reaches into the viewing cone of the camera.
bool is_in_view(const Cell& cell, const geometry::CameraModel& camera, const geometry::Pose& camera_from_world) {
  const double radius = kCellSize * std::sqrt(3.0);  // half a diagonal, and as much again for lines across cells
  const Eigen::Vector3d centre = camera_from_world * centre_of(cell);
  if (centre.norm() > kMaxRange + radius) return false;
  const double half_diagonal =
      std::hypot(camera.width / (2.0 * camera.fx), camera.height / (2.0 * std::abs(camera.fy)));
  const double half_angle = std::atan(half_diagonal);
  const double off_axis = std::atan2(centre.head<2>().norm(), centre.z());
  const double apparent = centre.norm() > radius ? std::asin(radius / centre.norm()) : M_PI;
  return off_axis - apparent < half_angle;
}

}  // namespace

Cell cell_of(const Eigen::Vector3d& position) {
  const Eigen::Vector3d scaled = position / kCellSize;
  return {static_cast<std::int32_t>(std::floor(scaled.x())), static_cast<std::int32_t>(std::floor(scaled.y())),
          static_cast<std::int32_t>(std::floor(scaled.z()))};
}

std::vector<Cell> cells_in_view(const geometry::CameraModel& camera, const geometry::Pose& camera_from_world) {
  const Cell centre = cell_of(camera_from_world.inverse().translation);
  const int reach = static_cast<int>(std::ceil(kMaxRange / kCellSize)) + 1;
  std::vector<Cell> cells;
  for (std::int32_t x = centre[0] - reach; x <= centre[0] + reach; ++x) {
    for (std::int32_t y = centre[1] - reach; y <= centre[1] + reach; ++y) {
      for (std::int32_t z = centre[2] - reach; z <= centre[2] + reach; ++z) {
        if (is_in_view({x, y, z}, camera, camera_from_world)) cells.push_back({x, y, z});
      }
    }
  }
  return cells;
}

}  // namespace eg::tracking
