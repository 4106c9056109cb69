#pragma once

#include "common/tracking/pose_optimizer.hpp"

namespace eg::tracking {

/// How well the measurements alone determine the pose: standard deviations along the worst direction.
struct Observability {
  double rotation_sigma = 0.0;                            ///< radians; infinite if unobserved
  double second_rotation_sigma = 0.0;                     ///< radians, along the second worst direction
  Eigen::Vector3d worst_turn = Eigen::Vector3d::UnitZ();  ///< axis of rotation_sigma, camera frame
  double translation_sigma = 0.0;                         ///< metres; infinite if unobserved
};

Observability observability(const Matrix6d& information);

}  // namespace eg::tracking
