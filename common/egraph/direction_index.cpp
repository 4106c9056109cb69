#include "common/egraph/direction_index.hpp"

#include <algorithm>
#include <cmath>

namespace eg::egraph {
namespace {

/// Edge of a cell, as a chord of the unit sphere: about 8°, the largest angle at which directions are associated.
constexpr double kCellSize = 0.14;

}  // namespace

DirectionIndex::Cell DirectionIndex::cell_of(const Eigen::Vector3d& direction) {
  const auto coordinate = [&](int axis) { return static_cast<int>(std::floor(direction[axis] / kCellSize)); };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

void DirectionIndex::insert(LandmarkId id, const Eigen::Vector3d& direction) {
  cells_[cell_of(direction)].push_back(id);
}

void DirectionIndex::erase(LandmarkId id, const Eigen::Vector3d& direction) {
  const auto cell = cells_.find(cell_of(direction));
  if (cell == cells_.end()) return;
  std::erase(cell->second, id);
  if (cell->second.empty()) cells_.erase(cell);
}

std::vector<LandmarkId> DirectionIndex::near(const Eigen::Vector3d& direction, double max_angle) const {
  const int reach = static_cast<int>(std::ceil(2.0 * std::sin(0.5 * max_angle) / kCellSize));
  std::vector<LandmarkId> found;
  for (const double sign : {1.0, -1.0}) {
    const Cell centre = cell_of(sign * direction);
    for (int x = centre[0] - reach; x <= centre[0] + reach; ++x) {
      for (int y = centre[1] - reach; y <= centre[1] + reach; ++y) {
        const auto end = cells_.upper_bound({x, y, centre[2] + reach});
        for (auto cell = cells_.lower_bound({x, y, centre[2] - reach}); cell != end; ++cell) {
          found.insert(found.end(), cell->second.begin(), cell->second.end());
        }
      }
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace eg::egraph
