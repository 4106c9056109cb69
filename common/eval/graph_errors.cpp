#include "common/eval/graph_errors.hpp"

#include <algorithm>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "common/base/check.hpp"
#include "common/eval/alignment.hpp"
#include "common/eval/frustum.hpp"
#include "common/geometry/so3.hpp"

namespace eg::eval {
namespace {

/// The true pose of every keyframe, where there is one.
std::vector<std::optional<geometry::Pose>> reference_poses(std::span<const geometry::StampedPose> keyframes,
                                                           std::span<const geometry::StampedPose> reference,
                                                           double max_time_difference_s) {
  std::vector<std::optional<geometry::Pose>> poses;
  for (const geometry::StampedPose& keyframe : keyframes) {
    const auto pair = match_by_time({&keyframe, 1}, reference, max_time_difference_s);
    poses.push_back(pair.empty() ? std::nullopt : std::optional(pair.front().reference));
  }
  return poses;
}

double relative_rotation_error_deg(const geometry::Pose& first, const geometry::Pose& second,
                                   const geometry::Pose& true_first, const geometry::Pose& true_second) {
  const Eigen::Matrix3d estimated = first.rotation.transpose() * second.rotation;
  const Eigen::Matrix3d truth = true_first.rotation.transpose() * true_second.rotation;
  return geometry::rotation_angle_between(estimated, truth) * 180.0 / std::numbers::pi;
}

}  // namespace

base::Result<GraphErrors> evaluate_graph(std::span<const geometry::StampedPose> keyframes,
                                         std::span<const GraphEdge> edges,
                                         std::span<const geometry::StampedPose> reference,
                                         const GraphErrorOptions& options) {
  EG_CHECK(geometry::validate(options.camera).has_value(), "the overlap of views needs a valid camera");
  const auto truth = reference_poses(keyframes, reference, options.max_time_difference_s);
  if (std::none_of(truth.begin(), truth.end(), [](const auto& pose) { return pose.has_value(); })) {
    return base::fail("none of the " + std::to_string(keyframes.size()) +
                      " keyframes has a reference pose at its time");
  }
  const auto frustum_of = [&](const geometry::Pose& world_from_camera) {
    return Frustum(options.camera, world_from_camera, options.nearest_m, options.farthest_m);
  };
  GraphErrors result;
  result.keyframes = keyframes.size();
  result.edges = edges.size();
  std::vector<double> overlapping, non_overlapping, all;
  for (const auto& [first, second] : edges) {
    EG_CHECK(first < keyframes.size() && second < keyframes.size(), "an edge refers to a keyframe that does not exist");
    if (!truth[first] || !truth[second]) {
      ++result.edges_without_reference;
      continue;
    }
    const double error = relative_rotation_error_deg(
        keyframes[first].world_from_camera, keyframes[second].world_from_camera, *truth[first], *truth[second]);
    all.push_back(error);
    const bool overlap = frustum_of(*truth[first]).intersects(frustum_of(*truth[second]));
    (overlap ? overlapping : non_overlapping).push_back(error);
  }
  result.all_deg = statistics_of(all);
  result.overlapping_deg = statistics_of(overlapping);
  result.non_overlapping_deg = statistics_of(non_overlapping);
  return result;
}

}  // namespace eg::eval
