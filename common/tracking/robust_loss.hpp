#pragma once

#include <cmath>

/// Robust losses on the squared norm of a whitened residual (chi²), as iteratively reweighted least squares wants them
/// (Triggs, McLauchlan, Hartley and Fitzgibbon 2000, section 4.3).
namespace eg::tracking {

/// 95 % quantiles of chi² with one to four degrees of freedom: the scales of the losses, and the gates on outliers.
inline constexpr double kChi2One = 3.84;
inline constexpr double kChi2Two = 5.99;
inline constexpr double kChi2Three = 7.81;
inline constexpr double kChi2Four = 9.49;

struct RobustLoss {
  double weight = 1.0;  ///< derivative of the cost by chi²
  double cost = 0.0;    ///< chi² where it is small
};

/// Quadratic up to `scale`, linear in the residual beyond it (Huber 1964): an outlier pulls with a constant force. For
/// measurements whose errors are Gaussian, apart from few mistakes.
inline RobustLoss huber(double chi2, double scale) {
  if (chi2 <= scale) return {1.0, chi2};
  return {std::sqrt(scale / chi2), 2.0 * std::sqrt(scale * chi2) - scale};
}

/// The likelihood of a Cauchy distribution: an outlier pulls the less the farther it is off. For measurements of which
/// many lie far outside their standard deviations: points at the outlines of things, and how a hand moves.
inline RobustLoss cauchy(double chi2, double scale) {
  return {1.0 / (1.0 + chi2 / scale), scale * std::log1p(chi2 / scale)};
}

}  // namespace eg::tracking
