#include "common/features/direction_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "common/features/direction_significance.hpp"
#include "common/features/vanishing_linkage.hpp"
#include "common/features/vanishing_preferences.hpp"
#include "common/geometry/so3.hpp"

namespace eg::features {
namespace {

using Lines = std::vector<DirectionEvidence>;
using Groups = std::vector<DirectionGroup>;

constexpr int kAssignments = 2;  // rounds of giving lines to groups and refitting them

std::vector<std::vector<int>> cluster_segments(const Lines& lines, const geometry::CameraModel& camera,
                                               const DirectionExtractorOptions& options) {
  std::vector<DirectionalSegment> segments;
  for (const DirectionEvidence& line : lines) segments.push_back(line.segment);
  const std::vector<int> labels =
      j_linkage(preference_sets(segments, camera, options.hypotheses, options.max_linkage_error, options.seed));
  std::vector<std::vector<int>> clusters;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto label = static_cast<std::size_t>(labels[i]);
    if (label >= clusters.size()) clusters.resize(label + 1);
    clusters[label].push_back(static_cast<int>(i));
  }
  return clusters;
}

double support_of(const Lines& lines, const DirectionGroup& group) {
  double length = 0.0;
  for (const int member : group.members) length += lines[static_cast<std::size_t>(member)].length;
  return length;
}

void sort_by_support(const Lines& lines, Groups& groups) {
  std::stable_sort(groups.begin(), groups.end(), [&](const DirectionGroup& a, const DirectionGroup& b) {
    return support_of(lines, a) > support_of(lines, b);
  });
}

bool near_any(const Eigen::Vector3d& direction, const Groups& groups, double angle) {
  return std::any_of(groups.begin(), groups.end(), [&](const DirectionGroup& group) {
    return geometry::axial_angle(direction, group.estimate.direction) < angle;
  });
}

/// Drops groups whose direction a better supported group has; their lines find it when they are assigned again.
Groups without_duplicates(const Lines& lines, Groups groups, double same_direction) {
  sort_by_support(lines, groups);
  Groups kept;
  for (DirectionGroup& group : groups) {
    if (!near_any(group.estimate.direction, kept, same_direction)) kept.push_back(std::move(group));
  }
  return kept;
}

/// The group a line fits best among those it agrees with: by the angle between the line and the direction in the image,
/// and in space if the line has depth, both in standard deviations.
std::optional<std::size_t> best_group(const DirectionEvidence& line, const Groups& groups,
                                      const geometry::CameraModel& camera, const DirectionGroupOptions& options) {
  std::optional<std::size_t> best;
  double best_cost = 0.0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const DirectionEstimate& estimate = groups[i].estimate;
    if (!agrees(line, estimate.direction, estimate.max_sigma(), camera, options)) continue;
    const double in_image = line.segment.plane_normal.dot(estimate.direction) / line.normal_sigma(estimate.direction);
    const double in_space = line.has_depth ? line.sideways.dot(estimate.direction) / line.sideways_sigma : 0.0;
    const double cost = in_image * in_image + in_space * in_space;
    if (best && cost >= best_cost) continue;
    best = i;
    best_cost = cost;
  }
  return best;
}

/// Every line goes to its best group, every group is fitted to its lines, groups left with too few lines dissolve.
Groups reassign(const Lines& lines, const Groups& groups, const geometry::CameraModel& camera,
                const DirectionGroupOptions& options) {
  std::vector<std::vector<int>> members(groups.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (const auto group = best_group(lines[i], groups, camera, options))
      members[*group].push_back(static_cast<int>(i));
  }
  Groups refitted;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (auto group = fit_group(lines, members[i], groups[i].estimate.direction, options)) {
      refitted.push_back(std::move(*group));
    }
  }
  return refitted;
}

/// Lines in space that J-Linkage left alone but that are parallel to each other.
void add_parallel_pairs(const Lines& lines, const geometry::CameraModel& camera, const DirectionGroupOptions& options,
                        Groups& groups) {
  std::vector<char> taken(lines.size(), 0);
  for (const DirectionGroup& group : groups) {
    for (const int member : group.members) taken[static_cast<std::size_t>(member)] = 1;
  }
  std::vector<int> left;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (taken[i] == 0 && lines[i].has_depth) left.push_back(static_cast<int>(i));
  }
  while (left.size() >= 2) {
    auto group = check_group(lines, left, camera, options);
    if (!group) return;
    std::erase_if(left,
                  [&](int line) { return std::binary_search(group->members.begin(), group->members.end(), line); });
    groups.push_back(std::move(*group));
  }
}

/// Keeps the groups that chance does not explain. Lines of better supported groups are no candidates for the others.
Groups significant(const Lines& lines, Groups groups, const DirectionExtractorOptions& options) {
  sort_by_support(lines, groups);
  int candidates = static_cast<int>(lines.size());
  Groups kept;
  for (DirectionGroup& group : groups) {
    const double false_alarms = log_false_alarms(lines, group, candidates, options.group);
    if (false_alarms > std::log(options.max_false_alarms)) continue;
    candidates -= static_cast<int>(group.members.size());
    kept.push_back(std::move(group));
  }
  return kept;
}

Groups find_groups(const Lines& lines, const geometry::CameraModel& camera, const DirectionExtractorOptions& options) {
  Groups groups;
  for (const std::vector<int>& cluster : cluster_segments(lines, camera, options)) {
    if (auto group = check_group(lines, cluster, camera, options.group)) groups.push_back(std::move(*group));
  }
  add_parallel_pairs(lines, camera, options.group, groups);
  for (int i = 0; i < kAssignments; ++i) {
    groups = without_duplicates(lines, std::move(groups), options.same_direction);
    groups = reassign(lines, groups, camera, options.group);
  }
  return significant(lines, std::move(groups), options);
}

/// Covariance of `sigma` radians about every axis across a direction.
Eigen::Matrix3d tangential(const Eigen::Vector3d& direction, double sigma) {
  return sigma * sigma * (Eigen::Matrix3d::Identity() - direction * direction.transpose());
}

Eigen::Matrix3d with_floor(const DirectionEstimate& estimate, double floor) {
  return estimate.covariance + tangential(estimate.direction, floor);
}

DirectionFeature vanishing_direction(const DirectionGroup& group, double floor) {
  return {DirectionKind::vanishing_direction, group.estimate.direction, with_floor(group.estimate, floor),
          static_cast<std::int32_t>(group.members.size()), -1};
}

/// None for a line of one of the groups that is measured badly: it says nothing new.
std::optional<DirectionFeature> potential_direction(const DirectionEvidence& line, int index, const Groups& groups,
                                                    const DirectionExtractorOptions& options) {
  if (!line.has_depth || near_any(line.direction, groups, options.same_direction)) return std::nullopt;
  const auto estimate = fit_direction({&line}, line.direction);
  if (!estimate || estimate->max_sigma() > options.max_potential_sigma) return std::nullopt;
  return DirectionFeature{DirectionKind::potential_direction, estimate->direction,
                          with_floor(*estimate, options.sigma_floor), 1, index};
}

}  // namespace

base::Status validate(const DirectionExtractorOptions& options) {
  if (options.hypotheses < 1 || options.hypotheses > kMaxHypotheses) {
    return base::fail("directions.hypotheses must be in 1.." + std::to_string(kMaxHypotheses));
  }
  if (!(options.max_linkage_error > 0.0)) return base::fail("directions.max_linkage_error must be positive");
  if (!(options.group.max_pixel_error > 0.0)) return base::fail("directions.max_pixel_error must be positive");
  if (!(options.group.max_sigmas > 0.0)) return base::fail("directions.max_sigmas must be positive");
  if (options.group.min_depth_lines < 2) return base::fail("directions.min_depth_lines must be at least 2");
  if (options.group.min_image_lines < 3) return base::fail("directions.min_image_lines must be at least 3");
  if (!(options.group.max_group_sigma > 0.0)) return base::fail("directions.max_group_sigma must be positive");
  if (!(options.max_false_alarms > 0.0)) return base::fail("directions.max_false_alarms must be positive");
  if (!(options.sigma_floor >= 0.0)) return base::fail("directions.sigma_floor must not be negative");
  if (!(options.warp_sigma >= 0.0)) return base::fail("directions.warp_sigma must not be negative");
  if (options.max_potential < 0) return base::fail("directions.max_potential must not be negative");
  return {};
}

std::vector<DirectionFeature> extract_line_directions(std::vector<MeasuredLine>& lines,
                                                      const geometry::CameraModel& camera,
                                                      const DirectionExtractorOptions& options) {
  Lines evidence;
  evidence.reserve(lines.size());
  for (const MeasuredLine& line : lines) evidence.push_back(make_evidence(line, camera));

  std::vector<DirectionFeature> directions;
  for (MeasuredLine& line : lines) line.feature.direction = -1;
  const Groups groups = find_groups(evidence, camera, options);
  for (const DirectionGroup& group : groups) {
    for (const int member : group.members) {
      lines[static_cast<std::size_t>(member)].feature.direction = static_cast<std::int32_t>(directions.size());
    }
    directions.push_back(vanishing_direction(group, options.sigma_floor));
  }
  int potential = 0;
  for (std::size_t i = 0; i < lines.size() && potential < options.max_potential; ++i) {
    if (lines[i].feature.direction >= 0) continue;
    const auto direction = potential_direction(evidence[i], static_cast<int>(i), groups, options);
    if (!direction) continue;
    lines[i].feature.direction = static_cast<std::int32_t>(directions.size());
    directions.push_back(*direction);
    ++potential;
  }
  return directions;
}

void add_warp(double warp, const DirectionExtractorOptions& options, std::vector<DirectionFeature>& line_directions) {
  for (DirectionFeature& direction : line_directions) {
    direction.covariance += tangential(direction.direction, warp * options.warp_sigma);
  }
}

std::vector<DirectionFeature> plane_directions(const std::vector<PlaneFeature>& planes) {
  std::vector<DirectionFeature> directions;
  directions.reserve(planes.size());
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const PlaneFeature& plane = planes[i];
    const Eigen::Vector3d& normal = plane.plane.normal;
    const Eigen::Matrix3d tangential = Eigen::Matrix3d::Identity() - normal * normal.transpose();
    const Eigen::Matrix3d covariance = tangential * plane.covariance.topLeftCorner<3, 3>() * tangential;
    directions.push_back(
        {DirectionKind::plane_normal, normal, covariance, plane.support, static_cast<std::int32_t>(i)});
  }
  return directions;
}

}  // namespace eg::features
