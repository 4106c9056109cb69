#include "common/features/plane_tolerance.hpp"

namespace eg::features {

PlaneTolerance::PlaneTolerance(const geometry::CameraModel& camera, double lateral_sigma, double max_error,
                               double flatness)
    : lateral_(lateral_sigma / camera.fx, lateral_sigma / camera.fy, 0.0),
      max_squared_error_(max_error * max_error),
      squared_flatness_(flatness * flatness) {}

bool PlaneTolerance::accepts(const PlaneMoments& region, const InverseDepthPlane& plane) const {
  const double precision = region.weight / region.pixels;  // 1/variance of one reading's noise along the ray
  const double w = region.w / region.weight;
  const double noise = max_squared_error_ * (1.0 + lateral_variance(plane) * precision);
  const double bumps = squared_flatness_ * w * w * w * w * precision;
  return region.mean_squared_error(plane) <= noise + bumps;
}

double PlaneTolerance::variance(double inverse_depth, const InverseDepthPlane& plane) const {
  const double sigma = inverse_depth_sigma(inverse_depth);
  return sigma * sigma + lateral_variance(plane);
}

}  // namespace eg::features
