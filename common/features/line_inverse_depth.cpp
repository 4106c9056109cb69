#include "common/features/line_inverse_depth.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "common/base/random.hpp"

namespace eg::features {
namespace {

using Samples = std::vector<LineDepthSample>;
using Flags = std::vector<char>;

constexpr double kMaxSlopeAcross = 0.02;  // prior on the surface's relative change of inverse depth per pixel

/// (at_middle, slope along, slope across) by weighted least squares, as normal equations that samples are added to.
class NormalEquations {
 public:
  /// The prior on the slope across keeps the system regular when all samples lie on the segment.
  explicit NormalEquations(double typical_inverse_depth) {
    const double sigma = kMaxSlopeAcross * typical_inverse_depth;
    information_(2, 2) = 1.0 / (sigma * sigma);
  }

  void add(const LineDepthSample& sample) {
    const Eigen::Vector3d row(1.0, sample.along, sample.across);
    const double weight = 1.0 / (sample.sigma * sample.sigma);
    information_ += weight * row * row.transpose();
    right_ += weight * sample.inverse_depth * row;
  }

  /// None where the samples do not determine the line.
  [[nodiscard]] std::optional<Eigen::Vector3d> solve(Eigen::Matrix3d* covariance = nullptr) const {
    Eigen::Matrix3d inverse;
    bool invertible = false;
    // Scale to a unit diagonal, so that the test for singularity does not depend on units.
    const Eigen::Vector3d scale = information_.diagonal().cwiseSqrt();
    if ((scale.array() <= 0.0).any()) return std::nullopt;
    const Eigen::Vector3d unscale = scale.cwiseInverse();
    const Eigen::Matrix3d scaled = unscale.asDiagonal() * information_ * unscale.asDiagonal();
    scaled.computeInverseWithCheck(inverse, invertible, 1e-9);
    if (!invertible) return std::nullopt;
    const Eigen::Matrix3d cov = unscale.asDiagonal() * inverse * unscale.asDiagonal();
    if (covariance != nullptr) *covariance = cov;
    return cov * right_;
  }

 private:
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero();
};

double normalised_residual(const LineDepthSample& sample, const Eigen::Vector3d& model) {
  const double predicted = model[0] + model[1] * sample.along + model[2] * sample.across;
  return (sample.inverse_depth - predicted) / sample.sigma;
}

int count_inliers(const Samples& samples, const Eigen::Vector3d& model, double limit) {
  return static_cast<int>(std::count_if(samples.begin(), samples.end(), [&](const LineDepthSample& sample) {
    return std::abs(normalised_residual(sample, model)) <= limit;
  }));
}

double median_inverse_depth(Samples samples) {
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end(),
                   [](const auto& a, const auto& b) { return a.inverse_depth < b.inverse_depth; });
  return middle->inverse_depth;
}

/// Trials after which 99 % of runs have drawn one all-inlier sample of three.
int trials_needed(double inlier_ratio, int max_trials) {
  const double good = inlier_ratio * inlier_ratio * inlier_ratio;
  if (good > 0.99) return 1;
  return std::min(max_trials, static_cast<int>(std::ceil(std::log(0.01) / std::log(1.0 - good))));
}

std::optional<Eigen::Vector3d> ransac(const Samples& samples, double typical, const LineLifterOptions& options,
                                      std::uint64_t seed) {
  base::Random random(seed);
  const int count = static_cast<int>(samples.size());
  std::optional<Eigen::Vector3d> best;
  int best_inliers = 0;
  int trials = options.max_iterations;
  for (int trial = 0; trial < trials; ++trial) {
    NormalEquations equations(typical);
    for (int i = 0; i < 3; ++i) equations.add(samples[static_cast<std::size_t>(random.index(count))]);
    const auto model = equations.solve();
    if (!model) continue;
    const int inliers = count_inliers(samples, *model, options.inlier_sigmas);
    if (inliers <= best_inliers) continue;
    best = model;
    best_inliers = inliers;
    trials = trials_needed(static_cast<double>(inliers) / count, options.max_iterations);
  }
  return best;
}

Samples inliers_of(const Samples& samples, const Eigen::Vector3d& model, double limit) {
  Samples inliers;
  inliers.reserve(samples.size());
  std::copy_if(samples.begin(), samples.end(), std::back_inserter(inliers),
               [&](const LineDepthSample& sample) { return std::abs(normalised_residual(sample, model)) <= limit; });
  return inliers;
}

/// By how much the fit's covariance is to be multiplied: observed over modelled variance (shrunk towards 1, few samples
/// say little) times the loss of information by correlated neighbours, (1 + r) / (1 - r) for an autoregressive noise of
/// lag-one correlation r.
double covariance_scale(const Samples& inliers, const Eigen::Vector3d& model) {
  constexpr double kPriorSamples = 5.0;
  constexpr double kMaxCorrelation = 0.9;
  double squares = 0.0;
  double products = 0.0;
  double previous = 0.0;
  double previous_along = 3.0;  // past any end
  for (const LineDepthSample& sample : inliers) {
    const double residual = normalised_residual(sample, model);
    squares += residual * residual;
    const bool same_row = sample.along > previous_along - 1.0;
    if (same_row) products += previous * residual;
    previous = residual;
    previous_along = sample.along;
  }
  const double variance = (kPriorSamples + squares) / (kPriorSamples + static_cast<double>(inliers.size()));
  const double correlation = squares > 0.0 ? std::clamp(products / squares, 0.0, kMaxCorrelation) : 0.0;
  return variance * (1.0 + correlation) / (1.0 - correlation);
}

bool enough(const Samples& inliers, int expected, const LineLifterOptions& options) {
  const int count = static_cast<int>(inliers.size());
  if (count < options.min_inliers || count < options.min_inlier_ratio * expected) return false;
  const auto [first, last] = std::minmax_element(inliers.begin(), inliers.end(),
                                                 [](const auto& a, const auto& b) { return a.along < b.along; });
  return last->along - first->along >= 2.0 * options.min_coverage;
}

}  // namespace

std::optional<InverseDepthLine> fit_inverse_depth(const LineDepthSamples& samples, const LineLifterOptions& options,
                                                  std::uint64_t seed) {
  if (!enough(samples.samples, samples.expected, options)) return std::nullopt;
  const double typical = median_inverse_depth(samples.samples);
  auto model = ransac(samples.samples, typical, options, seed);
  if (!model) return std::nullopt;

  Samples inliers;
  Eigen::Matrix3d covariance;
  constexpr int kRefits = 2;
  for (int i = 0; i < kRefits; ++i) {
    inliers = inliers_of(samples.samples, *model, options.inlier_sigmas);
    if (!enough(inliers, samples.expected, options)) return std::nullopt;
    NormalEquations equations(typical);
    for (const LineDepthSample& sample : inliers) equations.add(sample);
    model = equations.solve(&covariance);
    if (!model) return std::nullopt;
  }
  covariance *= covariance_scale(inliers, *model);
  return InverseDepthLine{(*model)[0], (*model)[1], covariance.topLeftCorner<2, 2>()};
}

}  // namespace eg::features
