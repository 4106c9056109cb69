#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/pose.hpp"
#include "common/tracking/pose_optimizer.hpp"

namespace eg::tracking {

struct MotionOptions {
  double velocity_change = 0.4;          ///< m/s that a hand or robot may change its speed by within one frame
  double angular_velocity_change = 0.4;  ///< rad/s, likewise (12 rad/s² at 30 Hz)
  double max_extrapolation_s = 0.5;      ///< a longer gap says nothing about where the camera went
  /// rad/sqrt(s), random walk about the one axis that a single wall leaves open: its normal. Whoever carries a camera
  /// along a wall pans; turning the picture about the viewing direction is rare.
  double unseen_turn = 0.03;
};

/// Constant velocity between frames, with the uncertainty that a change of velocity brings. While something is not
/// measured its uncertainty grows from frame to frame.
class MotionModel {
 public:
  explicit MotionModel(MotionOptions options = {}) : options_(options) {}

  /// The next frame's pose as a prior. Without history: the last pose.
  [[nodiscard]] MotionPrior predict(std::int64_t utime) const;

  /// `translation_measured`: without it there is no velocity either; the camera is expected to stay. `unseen_turn`: the
  /// axis (camera frame) about which the rotation was not measured; the camera is expected not to turn about it.
  void update(std::int64_t utime, const geometry::Pose& camera_from_world, bool translation_measured,
              const std::optional<Eigen::Vector3d>& unseen_turn = std::nullopt);

  /// How far the camera may have turned unseen so far, radians.
  [[nodiscard]] double unseen_turn_sigma() const { return unseen_turn_sigma_; }

  /// Puts the last pose elsewhere (the map was corrected under it) and keeps the velocity.
  void correct(const geometry::Pose& camera_from_world) { camera_from_world_ = camera_from_world; }
  /// The same for a map that moved by `motion`, in the world.
  void correct_by(const geometry::Pose& motion) { camera_from_world_ = camera_from_world_ * motion.inverse(); }

  /// Forgets the velocity (first frame, relocalisation).
  void reset(std::int64_t utime, const geometry::Pose& camera_from_world);

 private:
  MotionOptions options_;
  std::int64_t utime_ = 0;
  geometry::Pose camera_from_world_;
  double translation_sigma_ = 0.0;      ///< of camera_from_world_, metres: what was not measured so far
  double unseen_turn_sigma_ = 0.0;      ///< radians, likewise
  std::optional<geometry::Pose> step_;  ///< current_from_last camera
  double step_seconds_ = 0.0;
};

}  // namespace eg::tracking
