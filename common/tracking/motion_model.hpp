#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/pose.hpp"
#include "common/tracking/pose_optimizer.hpp"

namespace eg::tracking {

struct MotionOptions {
  double velocity_change = 0.4;          ///< m/s that a hand or robot may change its speed by within one frame
  double angular_velocity_change = 1.2;  ///< rad/s, likewise
  double max_extrapolation_s = 0.5;      ///< a longer gap says nothing about where the camera went
};

/// Constant velocity between frames, with the uncertainty that a change of velocity brings.
class MotionModel {
 public:
  explicit MotionModel(MotionOptions options = {}) : options_(options) {}

  /// The next frame's pose as a prior. Without history: the last pose, wide open.
  [[nodiscard]] MotionPrior predict(std::int64_t utime) const;

  /// `velocity_known`: false when the translation was not measured; the camera is then expected to stay.
  void update(std::int64_t utime, const geometry::Pose& camera_from_world, bool velocity_known);

  /// Forgets the velocity (after a relocalisation).
  void reset(std::int64_t utime, const geometry::Pose& camera_from_world);

  /// The world was corrected: the last pose becomes `camera_from_world`, the velocity stays.
  void move(const geometry::Pose& camera_from_world) { camera_from_world_ = camera_from_world; }

 private:
  MotionOptions options_;
  std::int64_t utime_ = 0;
  geometry::Pose camera_from_world_;
  std::optional<geometry::Pose> step_;  ///< current_from_last camera
  double step_seconds_ = 0.0;
};

}  // namespace eg::tracking
