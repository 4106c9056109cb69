#include "common/tracking/motion_model.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/so3.hpp"

namespace eg::tracking {
namespace {

/// The motion of `step` over another length of time.
geometry::Pose scaled(const geometry::Pose& step, double factor) {
  return {geometry::so3_exp(factor * geometry::so3_log(step.rotation)), factor * step.translation};
}

double seconds(std::int64_t utime) { return static_cast<double>(utime) * 1e-6; }

}  // namespace

MotionPrior MotionModel::predict(std::int64_t utime) const {
  const double elapsed = std::max(1e-3, seconds(utime - utime_));
  MotionPrior prior;
  prior.rotation_sigma = std::hypot(unseen_turn_sigma_, options_.angular_velocity_change * elapsed);
  prior.translation_sigma = std::hypot(translation_sigma_, options_.velocity_change * elapsed);
  prior.camera_from_world = camera_from_world_;
  if (step_ && elapsed <= options_.max_extrapolation_s) {
    prior.camera_from_world = scaled(*step_, elapsed / step_seconds_) * camera_from_world_;
  }
  return prior;
}

void MotionModel::update(std::int64_t utime, const geometry::Pose& camera_from_world, bool translation_measured,
                         const std::optional<Eigen::Vector3d>& unseen_turn) {
  const double elapsed = std::max(0.0, seconds(utime - utime_));
  unseen_turn_sigma_ = unseen_turn ? std::hypot(unseen_turn_sigma_, options_.unseen_turn * std::sqrt(elapsed)) : 0.0;
  translation_sigma_ = translation_measured ? 0.0 : predict(utime).translation_sigma;
  step_.reset();
  if (utime > utime_) {
    step_ = camera_from_world * camera_from_world_.inverse();
    step_seconds_ = elapsed;
    if (!translation_measured) step_->translation.setZero();
    if (unseen_turn) {
      const Eigen::Vector3d turn = geometry::so3_log(step_->rotation);
      step_->rotation = geometry::so3_exp(turn - unseen_turn->dot(turn) * *unseen_turn);
    }
  }
  utime_ = utime;
  camera_from_world_ = camera_from_world;
}

void MotionModel::reset(std::int64_t utime, const geometry::Pose& camera_from_world) {
  *this = MotionModel(options_);
  utime_ = utime;
  camera_from_world_ = camera_from_world;
}

}  // namespace eg::tracking
