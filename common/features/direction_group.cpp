#include "common/features/direction_group.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/so3.hpp"

namespace eg::features {
namespace {

using Lines = std::vector<DirectionEvidence>;

const DirectionEvidence& at(const Lines& lines, int index) { return lines[static_cast<std::size_t>(index)]; }

std::vector<const DirectionEvidence*> pointers(const Lines& lines, const std::vector<int>& members) {
  std::vector<const DirectionEvidence*> evidence;
  evidence.reserve(members.size());
  for (const int member : members) evidence.push_back(&at(lines, member));
  return evidence;
}

double total_length(const Lines& lines, const std::vector<int>& members) {
  double sum = 0.0;
  for (const int member : members) sum += at(lines, member).length;
  return sum;
}

int depth_count(const Lines& lines, const std::vector<int>& members) {
  return static_cast<int>(
      std::count_if(members.begin(), members.end(), [&](int member) { return at(lines, member).has_depth; }));
}

/// The vanishing point of the segments alone.
std::optional<DirectionEstimate> fit_image_only(const Lines& lines, const std::vector<int>& cluster) {
  Lines flat;
  flat.reserve(cluster.size());
  for (const int member : cluster) {
    flat.push_back(at(lines, member));
    flat.back().has_depth = false;
  }
  std::vector<const DirectionEvidence*> evidence;
  evidence.reserve(flat.size());
  for (const DirectionEvidence& line : flat) evidence.push_back(&line);
  // Any start will do but one along a normal; the sum of all normals' outer products has the vanishing direction as its
  // smallest eigenvector, which the first iteration finds.
  return fit_direction(evidence, flat.front().segment.plane_normal.unitOrthogonal());
}

std::vector<DirectionEstimate> candidates(const Lines& lines, const std::vector<int>& cluster) {
  constexpr std::size_t kMaxCandidates = 24;
  std::vector<DirectionEstimate> result;
  result.reserve(std::min(kMaxCandidates, cluster.size() + 1));
  if (cluster.size() >= 2) {
    if (const auto vanishing = fit_image_only(lines, cluster)) result.push_back(*vanishing);
  }
  for (const int member : cluster) {  // the longest lines come first
    if (result.size() >= kMaxCandidates) break;
    if (!at(lines, member).has_depth) continue;
    if (const auto single = fit_direction({&at(lines, member)}, at(lines, member).direction)) result.push_back(*single);
  }
  return result;
}

std::vector<int> inliers_of(const Lines& lines, const std::vector<int>& cluster, const DirectionEstimate& estimate,
                            const geometry::CameraModel& camera, const DirectionGroupOptions& options) {
  const double sigma = std::min(estimate.max_sigma(), options.max_depth_angle);
  std::vector<int> inliers;
  inliers.reserve(cluster.size());
  for (const int member : cluster) {
    if (agrees(at(lines, member), estimate.direction, sigma, camera, options)) inliers.push_back(member);
  }
  return inliers;
}

}  // namespace

bool agrees(const DirectionEvidence& line, const Eigen::Vector3d& direction, double direction_sigma,
            const geometry::CameraModel& camera, const DirectionGroupOptions& options) {
  if (vanishing_error(line.segment, direction, camera) > options.max_pixel_error) return false;
  if (!line.has_depth) return true;
  const double angle = geometry::axial_angle(line.direction, direction);
  return angle <= options.max_depth_angle &&
         angle <= options.max_sigmas * std::hypot(line.sideways_sigma, line.normal_sigma(direction), direction_sigma);
}

std::optional<DirectionGroup> fit_group(const std::vector<DirectionEvidence>& lines, std::vector<int> members,
                                        const Eigen::Vector3d& initial, const DirectionGroupOptions& options) {
  const bool enough = depth_count(lines, members) >= options.min_depth_lines ||
                      static_cast<int>(members.size()) >= options.min_image_lines;
  if (!enough) return std::nullopt;
  const auto estimate = fit_direction(pointers(lines, members), initial);
  if (!estimate || estimate->max_sigma() > options.max_group_sigma) return std::nullopt;
  std::sort(members.begin(), members.end());
  return DirectionGroup{*estimate, std::move(members)};
}

std::optional<DirectionGroup> check_group(const std::vector<DirectionEvidence>& lines, const std::vector<int>& cluster,
                                          const geometry::CameraModel& camera, const DirectionGroupOptions& options) {
  constexpr int kRefinements = 2;
  std::optional<DirectionGroup> best;
  double best_length = 0.0;
  for (const DirectionEstimate& candidate : candidates(lines, cluster)) {
    auto group = fit_group(lines, inliers_of(lines, cluster, candidate, camera, options), candidate.direction, options);
    for (int i = 0; group && i < kRefinements; ++i) {
      const auto inliers = inliers_of(lines, cluster, group->estimate, camera, options);
      group = fit_group(lines, inliers, group->estimate.direction, options);
    }
    if (!group || total_length(lines, group->members) <= best_length) continue;
    best_length = total_length(lines, group->members);
    best = std::move(group);
  }
  return best;
}

}  // namespace eg::features
