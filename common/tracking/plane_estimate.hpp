#pragma once

#include <Eigen/Core>

#include "common/features/features.hpp"
#include "common/geometry/plane.hpp"
#include "common/geometry/pose.hpp"

namespace eg::tracking {

/// A plane with the covariance of (normal, distance): 4x4, rank 3, zero along the normal.
struct PlaneEstimate {
  geometry::Plane plane;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
};

/// The same plane in frame b. The distance's uncertainty grows with the lever of the normal's.
PlaneEstimate transform(const geometry::Pose& b_from_a, const PlaneEstimate& in_a);

/// The variance (m²) of the plane's height at a point.
double height_variance(const PlaneEstimate& plane, const Eigen::Vector3d& point);

/// The covariance-weighted mean of a plane and a new measurement of it, both in one frame.
void fuse(PlaneEstimate& plane, const PlaneEstimate& measurement);

}  // namespace eg::tracking
