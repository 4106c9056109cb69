#include "common/features/direction_significance.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace eg::features {
namespace {

double log_binomial(int n, int k) { return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0); }

/// Share of the angles in the image, or of the directions in space, at which a line would count as a member.
double chance_of_agreement(const DirectionEvidence& line, double group_sigma, const DirectionGroupOptions& options) {
  const double in_image = std::asin(std::min(1.0, options.max_pixel_error / line.segment.half.norm()));
  if (!line.has_depth) return 2.0 * in_image / std::numbers::pi;
  const double in_space = options.max_sigmas * std::hypot(line.sideways_sigma, group_sigma);
  const double limit = std::min(options.max_depth_angle, in_space);
  return 4.0 * std::min(in_image, limit) * limit / (2.0 * std::numbers::pi);  // of the half sphere's solid angle
}

}  // namespace

double log_false_alarms(const std::vector<DirectionEvidence>& lines, const DirectionGroup& group, int candidates,
                        const DirectionGroupOptions& options) {
  const double group_sigma = group.estimate.max_sigma();
  std::vector<double> log_chances;
  int in_space = 0;
  for (const int member : group.members) {
    const DirectionEvidence& line = lines[static_cast<std::size_t>(member)];
    log_chances.push_back(std::log(chance_of_agreement(line, group_sigma, options)));
    if (line.has_depth) ++in_space;
  }
  // The direction itself takes one line in space, or two in the image: the least telling ones.
  const std::size_t spent = std::min<std::size_t>(log_chances.size(), in_space > 0 ? 1 : 2);
  std::sort(log_chances.begin(), log_chances.end(), std::greater<>());
  double sum = log_binomial(std::max(candidates, static_cast<int>(group.members.size())),
                            static_cast<int>(group.members.size()));
  for (std::size_t i = spent; i < log_chances.size(); ++i) sum += log_chances[i];
  return sum;
}

}  // namespace eg::features
