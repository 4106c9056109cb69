#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <vector>

#include "common/egraph/types.hpp"

namespace eg::egraph {

/// Finds the landmarks around a direction without looking at all of them: a grid over the unit sphere, in which a
/// direction and its opposite are the same.
class DirectionIndex {
 public:
  void insert(LandmarkId id, const Eigen::Vector3d& direction);
  void erase(LandmarkId id, const Eigen::Vector3d& direction);

  /// All landmarks within `max_angle` (radians) of the direction or its opposite, and perhaps some more; by id.
  [[nodiscard]] std::vector<LandmarkId> near(const Eigen::Vector3d& direction, double max_angle) const;

 private:
  using Cell = std::array<int, 3>;

  static Cell cell_of(const Eigen::Vector3d& direction);

  std::map<Cell, std::vector<LandmarkId>> cells_;
};

}  // namespace eg::egraph
