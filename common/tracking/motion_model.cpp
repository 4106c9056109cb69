#include "common/tracking/motion_model.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/geometry/so3.hpp"
#include "common/tracking/pose_covariance.hpp"

namespace eg::tracking {
namespace {

Matrix6d variances(double turning, double moving) {
  Vector6d sigmas;
  sigmas << Eigen::Vector3d::Constant(turning), Eigen::Vector3d::Constant(moving);
  return sigmas.cwiseAbs2().asDiagonal();
}

Matrix6d symmetric(const Matrix6d& matrix) { return 0.5 * (matrix + matrix.transpose()); }

}  // namespace

Matrix6d MotionModel::unknown_velocity() const { return variances(options_.angular_speed, options_.speed); }

Matrix6d MotionModel::velocity_change(double elapsed) const {
  Matrix6d change = variances(options_.angular_velocity_change, options_.velocity_change);
  if (still_axis_) {
    const Eigen::Matrix3d along = *still_axis_ * still_axis_->transpose();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - along;
    change.topLeftCorner<3, 3>() =
        across * change.topLeftCorner<3, 3>() * across + options_.unseen_turn * options_.unseen_turn / elapsed * along;
  }
  return change;
}

MotionModel::State MotionModel::at(std::int64_t utime) const {
  const double elapsed = std::max(1e-3, 1e-6 * static_cast<double>(utime - utime_));
  State from = state_;
  if (elapsed > options_.memory_s) {
    from.velocity.setZero();
    from.velocity_covariance = unknown_velocity();
    from.cross.setZero();
  }
  const geometry::Pose step{geometry::so3_exp(elapsed * from.velocity.head<3>()), elapsed * from.velocity.tail<3>()};
  const double fading = std::exp(-elapsed / options_.memory_s);
  const Matrix6d carry = adjoint(step);
  const Matrix6d changed = from.velocity_covariance + velocity_change(elapsed);
  const Matrix6d cross = carry * from.cross;
  State to;
  to.camera_from_world = step * from.camera_from_world;
  to.velocity = fading * from.velocity;
  to.covariance = symmetric(carry * from.covariance * carry.transpose() + elapsed * (cross + cross.transpose()) +
                            elapsed * elapsed * changed);
  to.cross = fading * (cross + elapsed * changed);
  to.velocity_covariance = fading * fading * changed;
  return to;
}

MotionPrior MotionModel::predict(std::int64_t utime) const {
  const State state = at(utime);
  return {state.camera_from_world, state.covariance};
}

void MotionModel::update(std::int64_t utime, const geometry::Pose& camera_from_world, const Matrix6d& information,
                         const std::optional<Eigen::Vector3d>& unseen_turn) {
  const State predicted = at(utime);
  const Matrix6d prior = predicted.covariance.inverse();
  const Matrix6d posterior = symmetric((prior + information).inverse());
  // What the pose turned out to be tells of the velocity what the two have in common.
  const Matrix6d gain = predicted.cross.transpose() * prior;
  state_.velocity = predicted.velocity + gain * pose_difference(predicted.camera_from_world, camera_from_world);
  state_.velocity_covariance =
      symmetric(predicted.velocity_covariance - gain * (predicted.covariance - posterior) * gain.transpose());
  state_.cross = posterior * gain.transpose();
  state_.covariance = posterior;
  state_.camera_from_world = camera_from_world;
  utime_ = utime;
  still_axis_ = unseen_turn;
  if (!still_axis_) return;
  Matrix6d moving = Matrix6d::Identity();
  moving.topLeftCorner<3, 3>() -= *still_axis_ * still_axis_->transpose();
  state_.velocity = moving * state_.velocity;
  state_.velocity_covariance = moving * state_.velocity_covariance * moving;
  state_.cross = state_.cross * moving;
}

double MotionModel::unseen_turn_sigma() const {
  if (!still_axis_) return 0.0;
  return std::sqrt(still_axis_->dot(state_.covariance.topLeftCorner<3, 3>() * *still_axis_));
}

void MotionModel::reset(std::int64_t utime, const MotionPrior& place) {
  *this = MotionModel(options_);
  utime_ = utime;
  state_.camera_from_world = place.camera_from_world;
  state_.covariance = place.covariance;
  state_.velocity_covariance = unknown_velocity();
}

}  // namespace eg::tracking
