#include "common/features/plane_tolerance.hpp"

namespace eg::features {

PlaneTolerance::PlaneTolerance(const geometry::CameraModel& camera, double lateral_sigma, double max_error,
                               double flatness)
    : lateral_(lateral_sigma / camera.fx, lateral_sigma / camera.fy, 0.0),
      max_squared_error_(max_error * max_error),
      squared_flatness_(flatness * flatness) {}

bool PlaneTolerance::accepts(const PlaneMoments& region, const InverseDepthPlane& plane) const {
  const double precision = region.weight / region.pixels;  // 1/variance of one reading's noise along the ray
  return region.mean_squared_error(plane) <= precision * limit(1.0 / precision, region.w / region.weight, plane);
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
