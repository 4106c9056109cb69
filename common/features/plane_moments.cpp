#include "common/features/plane_moments.hpp"

#include <algorithm>

namespace eg::features {

PlaneMoments& PlaneMoments::operator+=(const PlaneMoments& other) {
  pixels += other.pixels;
  weight += other.weight;
  a += other.a;
  b += other.b;
  w += other.w;
  aa += other.aa;
  ab += other.ab;
  bb += other.bb;
  aw += other.aw;
  bw += other.bw;
  ww += other.ww;
  return *this;
}

PlaneMoments operator+(PlaneMoments left, const PlaneMoments& right) { return left += right; }

void PlaneMoments::scale(double factor) {
  for (double* sum : {&weight, &a, &b, &w, &aa, &ab, &bb, &aw, &bw, &ww}) *sum *= factor;
}

double PlaneMoments::mean_squared_error(const InverseDepthPlane& plane) const {
  const double p = plane.x(), q = plane.y(), r = plane.z();
  const double linear = p * aw + q * bw + r * w;
  const double quadratic = p * (p * aa + 2 * (q * ab + r * a)) + q * (q * bb + 2 * r * b) + r * r * weight;
  return std::max(0.0, ww - 2 * linear + quadratic) / pixels;
}

Eigen::Matrix3d PlaneMoments::normal_matrix() const {
  return (Eigen::Matrix3d() << aa, ab, a, ab, bb, b, a, b, weight).finished();
}

Eigen::Vector3d PlaneMoments::score(const InverseDepthPlane& plane) const {
  return Eigen::Vector3d(aw, bw, w) - normal_matrix() * plane;
}

PlaneFit fit_plane(const PlaneMoments& moments) {
  PlaneFit fit;
  if (moments.pixels < 3) return fit;
  // Central moments first: the 3x3 system falls apart into a well-conditioned 2x2 one and a mean.
  const double mean_a = moments.a / moments.weight;
  const double mean_b = moments.b / moments.weight;
  const double mean_w = moments.w / moments.weight;
  const double aa = moments.aa - mean_a * moments.a;
  const double ab = moments.ab - mean_a * moments.b;
  const double bb = moments.bb - mean_b * moments.b;
  const double aw = moments.aw - mean_a * moments.w;
  const double bw = moments.bw - mean_b * moments.w;
  const double ww = moments.ww - mean_w * moments.w;
  constexpr double kSmallestSpread = 1e-9;  // variance over squared mean: below it is what rounding leaves of zero
  if (aa <= kSmallestSpread * moments.aa || bb <= kSmallestSpread * moments.bb) return fit;
  constexpr double kSmallestDeterminant = 1e-6;  // of the correlation matrix of a and b
  const double determinant = aa * bb - ab * ab;
  if (!(determinant > kSmallestDeterminant * aa * bb)) return fit;
  const double slope_a = (bb * aw - ab * bw) / determinant;
  const double slope_b = (aa * bw - ab * aw) / determinant;
  fit.valid = true;
  fit.plane = {slope_a, slope_b, mean_w - slope_a * mean_a - slope_b * mean_b};
  fit.mean_squared_error = std::max(0.0, ww - slope_a * aw - slope_b * bw) / moments.pixels;
  return fit;
}

}  // namespace eg::features
