#include "common/features/plane_tolerance.hpp"

namespace eg::features {

PlaneTolerance::PlaneTolerance(const geometry::CameraModel& camera, double lateral_sigma, double block_pixels,
                               const Limits& limits)
    : lateral_(lateral_sigma / camera.fx, lateral_sigma / camera.fy, 0.0),
      block_pixels_(block_pixels),
      max_squared_error_(limits.max_error * limits.max_error),
      squared_flatness_(limits.flatness * limits.flatness),
      squared_bend_(limits.bend * limits.bend) {}

bool PlaneTolerance::accepts(const PlaneMoments& region, const InverseDepthPlane& plane) const {
  return region.mean_squared_error(plane) <= limit(region, plane);
}

bool PlaneTolerance::accepts_union(const PlaneMoments& region, double own_error, const InverseDepthPlane& plane) const {
  const double error = region.mean_squared_error(plane);
  const double largest = limit(region, plane);
  if (error > largest) return false;
  // The own plane of a small region follows its noise, by three degrees of freedom: allow three standard deviations.
  constexpr double kOfOneBlock = 12.0;
  return error - own_error <= squared_bend_ * largest * (1.0 + kOfOneBlock * block_pixels_ / region.pixels);
}

double PlaneTolerance::limit(const PlaneMoments& region, const InverseDepthPlane& plane) const {
  const double precision = region.weight / region.pixels;  // 1/variance of one reading's noise along the ray
  return precision * limit(1.0 / precision, region.w / region.weight, plane);
}

double PlaneTolerance::squared_limit(double inverse_depth, const InverseDepthPlane& plane) const {
  const double sigma = inverse_depth_sigma(inverse_depth);
  return limit(sigma * sigma, inverse_depth, plane);
}

double PlaneTolerance::limit(double variance, double inverse_depth, const InverseDepthPlane& plane) const {
  const double squared = inverse_depth * inverse_depth;  // a bump of height h changes the inverse depth w by w² h
  return max_squared_error_ * (variance + lateral_variance(plane)) + squared_flatness_ * squared * squared;
}

}  // namespace eg::features
