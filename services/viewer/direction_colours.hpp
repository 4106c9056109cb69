#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "common/egraph/types.hpp"

namespace eg::services {

/// Numbers for the scene's directions, so that everything along one direction is drawn in one colour: a wall's normal,
/// the vanishing direction perpendicular to the wall, and the lines of that group. The oldest landmarks have the lowest
/// numbers, hence a number stays while the graph grows.
class DirectionColours {
 public:
  static constexpr std::int32_t kNone = -1;

  DirectionColours() = default;
  explicit DirectionColours(std::span<const egraph::DirectionLandmark> landmarks);

  /// Of a unit direction in the world frame, whatever its sign; kNone: no direction of the graph is near it.
  [[nodiscard]] std::int32_t of(const Eigen::Vector3d& direction) const;

 private:
  std::vector<Eigen::Vector3d> directions_;  ///< by number
};

}  // namespace eg::services
