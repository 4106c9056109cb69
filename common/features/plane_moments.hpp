#pragma once

#include <Eigen/Core>

namespace eg::features {

/// A plane as the camera measures it: inverse depth is a linear function of the ray,
/// 1/z = gradient · (x/z, y/z, 1). Structured light measures disparity, so its noise lives in 1/z, and fitting there is
/// a linear problem without the bias that orthogonal distances have on slanted walls.
using InverseDepthPlane = Eigen::Vector3d;

/// Sums over pixels from which the plane of least squared inverse-depth error follows in closed form. Sums of disjoint
/// regions add up, which is what makes clustering cheap (Feng, Taguchi, Kamat, ICRA 2014, section III-C). After `scale`
/// by 1/variance, errors count in standard deviations of the sensor.
struct PlaneMoments {
  double pixels = 0;           ///< number of pixels; not scaled
  double weight = 0;           ///< sum of weights
  double a = 0, b = 0, w = 0;  ///< a = x/z, b = y/z, w = 1/z
  double aa = 0, ab = 0, bb = 0, aw = 0, bw = 0, ww = 0;

  /// Adds one pixel of weight 1.
  void add(double ray_x, double ray_y, double inverse_depth) {
    pixels += 1;
    weight += 1;
    a += ray_x;
    b += ray_y;
    w += inverse_depth;
    aa += ray_x * ray_x;
    ab += ray_x * ray_y;
    bb += ray_y * ray_y;
    aw += ray_x * inverse_depth;
    bw += ray_y * inverse_depth;
    ww += inverse_depth * inverse_depth;
  }

  PlaneMoments& operator+=(const PlaneMoments& other);

  /// Multiplies all weights by `factor`.
  void scale(double factor);

  /// Weighted mean squared error of the pixels under any plane.
  [[nodiscard]] double mean_squared_error(const InverseDepthPlane& plane) const;

  /// Matrix of the normal equations: sum of weight · r rᵀ with r = (a, b, 1).
  [[nodiscard]] Eigen::Matrix3d normal_matrix() const;

  /// Half the negative gradient of the squared error at `plane`: sum of weight · r (w - plane · r).
  [[nodiscard]] Eigen::Vector3d score(const InverseDepthPlane& plane) const;
};

PlaneMoments operator+(PlaneMoments left, const PlaneMoments& right);

/// The least-squares plane of a region.
struct PlaneFit {
  bool valid = false;  ///< false: the pixels do not determine a plane (fewer than three, or in one row)
  InverseDepthPlane plane = InverseDepthPlane::Zero();
  double mean_squared_error = 0;
};

PlaneFit fit_plane(const PlaneMoments& moments);

}  // namespace eg::features
