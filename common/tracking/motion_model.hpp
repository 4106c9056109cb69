#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/pose.hpp"
#include "common/tracking/pose_optimizer.hpp"

namespace eg::tracking {

struct MotionOptions {
  double velocity_change = 0.4;          ///< m/s that a hand or robot may change its speed by within one frame
  double angular_velocity_change = 0.2;  ///< rad/s per axis, likewise (6 rad/s² at 30 Hz)
  double speed = 0.4;                    ///< m/s of a camera of which nothing is known, on each axis
  double angular_speed = 0.4;            ///< rad/s, likewise
  double memory_s = 0.5;                 ///< after so long little is left of a velocity, and more tells nothing
  /// rad/sqrt(s), random walk about the one axis that a single wall leaves open: its normal. Whoever carries a camera
  /// along a wall pans; turning the picture about the viewing direction is rare.
  double unseen_turn = 0.03;
};

/// A Kalman filter over the camera's pose and velocity (Bar-Shalom, Li and Kirubarajan, Estimation with Applications to
/// Tracking and Navigation, 2001, sections 5.2 and 6.2): the velocity fades, and changes at random from frame to frame.
/// What one frame hardly measures keeps the velocity that earlier ones gave it, and grows uncertain.
class MotionModel {
 public:
  explicit MotionModel(MotionOptions options = {}) : options_(options) {}

  /// The next frame's pose as a prior.
  [[nodiscard]] MotionPrior predict(std::int64_t utime) const;

  /// `camera_from_world`: the pose that prior and measurements gave together. `information`: of the measurements alone,
  /// as in PoseSolution. `unseen_turn`: the axis (camera frame) about which the rotation was not measured; the camera
  /// is expected not to turn about it.
  void update(std::int64_t utime, const geometry::Pose& camera_from_world, const Matrix6d& information,
              const std::optional<Eigen::Vector3d>& unseen_turn = std::nullopt);

  /// How far the camera may have turned unseen so far, radians.
  [[nodiscard]] double unseen_turn_sigma() const;

  /// Puts the last pose elsewhere (the map was corrected under it) and keeps the velocity.
  void correct(const geometry::Pose& camera_from_world) { state_.camera_from_world = camera_from_world; }
  /// The same for a map that moved by `motion`, in the world.
  void correct_by(const geometry::Pose& motion) {
    state_.camera_from_world = state_.camera_from_world * motion.inverse();
  }

  /// Begins at a place of which nothing else is known (first frame, relocalisation).
  void reset(std::int64_t utime, const MotionPrior& place);

 private:
  using Velocity = Vector6d;  ///< (rad/s, m/s), camera frame

  struct State {
    geometry::Pose camera_from_world;
    Velocity velocity = Velocity::Zero();
    Matrix6d covariance = Matrix6d::Zero();  ///< of the pose: (rotation, translation), left perturbation
    Matrix6d cross = Matrix6d::Zero();       ///< of pose and velocity
    Matrix6d velocity_covariance = Matrix6d::Zero();
  };
  [[nodiscard]] State at(std::int64_t utime) const;
  [[nodiscard]] Matrix6d unknown_velocity() const;
  [[nodiscard]] Matrix6d velocity_change(double elapsed) const;

  MotionOptions options_;
  std::int64_t utime_ = 0;
  State state_;
  std::optional<Eigen::Vector3d> still_axis_;  ///< camera frame
};

}  // namespace eg::tracking
