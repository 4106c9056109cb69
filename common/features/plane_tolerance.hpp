#pragma once

#include "common/features/plane_extraction.hpp"
#include "common/features/plane_moments.hpp"
#include "common/geometry/camera_model.hpp"
#include "common/geometry/depth_noise.hpp"

namespace eg::features {

/// Standard deviation of the inverse depth w, from that of the depth: sigma_w = w² sigma_z(1/w). Nearly constant from 1
/// to 5 m, because structured light measures disparity.
inline double inverse_depth_sigma(double inverse_depth) {
  return inverse_depth * inverse_depth * geometry::depth_sigma(1.0 / inverse_depth);
}

/// How far readings may be from a plane that they belong to: the sensor's noise along the ray, its noise sideways,
/// which matters on steep surfaces, and what walls and the sensor's warp deviate from a plane.
class PlaneTolerance {
 public:
  struct Limits {
    double max_error = 1.0;  ///< standard deviations of a reading, rms
    double flatness = 0.0;   ///< metres
    double bend = 1.0;       ///< share of the two that the shape of a surface, and not its noise, may take up
  };

  /// `lateral_sigma` in pixels; `block_pixels`: how many pixels the smallest region has.
  PlaneTolerance(const geometry::CameraModel& camera, double lateral_sigma, double block_pixels, const Limits& limits);

  /// Whether a region is on `plane`, as a whole.
  [[nodiscard]] bool accepts(const PlaneMoments& region, const InverseDepthPlane& plane) const;

  /// Whether a region whose own plane has the mean squared error `own_error` is also on the plane of a union. What the
  /// union's plane adds to the error is the distance between the two planes, squared, and free of noise: it tells apart
  /// what is nearer to each other than the noise of one reading.
  [[nodiscard]] bool accepts_union(const PlaneMoments& region, double own_error, const InverseDepthPlane& plane) const;

  /// The largest squared error in units of inverse depth at a place on `plane`.
  [[nodiscard]] double squared_limit(double inverse_depth, const InverseDepthPlane& plane) const;

  /// The part of it that the noise sideways makes.
  [[nodiscard]] double lateral_variance(const InverseDepthPlane& plane) const {
    return plane.cwiseProduct(lateral_).squaredNorm();
  }

 private:
  /// squared_limit() for a given variance of the noise along the ray.
  [[nodiscard]] double limit(double variance, double inverse_depth, const InverseDepthPlane& plane) const;

  /// The largest mean squared error of a region, in the region's weights.
  [[nodiscard]] double limit(const PlaneMoments& region, const InverseDepthPlane& plane) const;

  Eigen::Vector3d lateral_;  ///< noise sideways, on the axes of the ray
  double block_pixels_;
  double max_squared_error_;
  double squared_flatness_;
  double squared_bend_;
};

}  // namespace eg::features
