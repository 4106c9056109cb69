#pragma once

#include <Eigen/Core>

namespace eg::geometry {

/// A rigid transform. `Pose b_from_a` takes coordinates in frame a (metres) to frame b: p_b = rotation p_a + translation.
struct Pose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  [[nodiscard]] Pose inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }

  friend Pose operator*(const Pose& c_from_b, const Pose& b_from_a) {
    return {c_from_b.rotation * b_from_a.rotation, c_from_b.rotation * b_from_a.translation + c_from_b.translation};
  }
  friend Eigen::Vector3d operator*(const Pose& b_from_a, const Eigen::Vector3d& point_in_a) {
    return b_from_a.rotation * point_in_a + b_from_a.translation;
  }
};

/// A pose at a time, as trajectories hold them.
struct StampedPose {
  double time_s = 0.0;
  Pose world_from_camera;
};

}  // namespace eg::geometry
