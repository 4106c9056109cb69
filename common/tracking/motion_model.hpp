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

/// Constant velocity between frames, with the uncertainty that a change of velocity brings. While something is not
/// measured its uncertainty grows from frame to frame.
class MotionModel {
 public:
  explicit MotionModel(MotionOptions options = {}) : options_(options) {}

  /// The next frame's pose as a prior. Without history: the last pose.
  [[nodiscard]] MotionPrior predict(std::int64_t utime) const;

  /// `translation_measured`: without it there is no velocity either; the camera is expected to stay.
  void update(std::int64_t utime, const geometry::Pose& camera_from_world, bool translation_measured);

  /// Puts the last pose elsewhere (the map was corrected under it) and keeps the velocity.
  void correct(const geometry::Pose& camera_from_world) { camera_from_world_ = camera_from_world; }

  /// Forgets the velocity (first frame, relocalisation).
  void reset(std::int64_t utime, const geometry::Pose& camera_from_world);

 private:
  MotionOptions options_;
  std::int64_t utime_ = 0;
  geometry::Pose camera_from_world_;
  double translation_sigma_ = 0.0;      ///< of camera_from_world_, metres: what was not measured so far
  std::optional<geometry::Pose> step_;  ///< current_from_last camera
  double step_seconds_ = 0.0;
};

}  // namespace eg::tracking
