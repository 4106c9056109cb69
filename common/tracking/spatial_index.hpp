#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/geometry/pose.hpp"

namespace eg::tracking {

/// A cube of space, counted from the world's origin.
using Cell = std::array<std::int32_t, 3>;

/// The cell that holds a position (world, metres).
Cell cell_of(const Eigen::Vector3d& position);

/// The cells that may hold what the camera sees, in a fixed order. Their number does not depend on the map.
std::vector<Cell> cells_in_view(const geometry::CameraModel& camera, const geometry::Pose& camera_from_world);

/// Landmarks by the place where they were made; they move less than a cell. What is removed costs no time afterwards.
template <typename Id>
class SpatialIndex {
 public:
  /// Ids come in order, from 0 on.
  void add(Id id, const Eigen::Vector3d& position) {
    cell_of_id_.push_back(cell_of(position));
    cells_[cell_of_id_.back()].push_back(id);
  }

  void remove(Id id) {
    const auto cell = cells_.find(cell_of_id_[static_cast<std::size_t>(id.value)]);
    if (cell == cells_.end()) return;
    std::erase(cell->second, id);
    if (cell->second.empty()) cells_.erase(cell);
  }

  /// What may be in view, by id.
  [[nodiscard]] std::vector<Id> near(const geometry::CameraModel& camera,
                                     const geometry::Pose& camera_from_world) const {
    std::vector<Id> ids;
    for (const Cell& at : cells_in_view(camera, camera_from_world)) {
      const auto cell = cells_.find(at);
      if (cell != cells_.end()) ids.insert(ids.end(), cell->second.begin(), cell->second.end());
    }
    std::sort(ids.begin(), ids.end());
    return ids;
  }

 private:
  std::map<Cell, std::vector<Id>> cells_;
  std::vector<Cell> cell_of_id_;
};

}  // namespace eg::tracking
