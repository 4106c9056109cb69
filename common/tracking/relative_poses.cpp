#include "common/tracking/relative_poses.hpp"

#include <algorithm>
#include <numeric>

#include "common/tracking/pose_covariance.hpp"

namespace eg::tracking {
std::vector<egraph::RelativePose> relative_poses(const Map& map, KeyframeId id, const egraph::Matrix6d& covariance,
                                                 std::size_t max_keyframes) {
  std::vector<egraph::Covisibility> most = map.covisible(id);  // most shared first
  std::erase_if(most, [&](const auto& other) { return other.keyframe > id; });
  most.resize(std::min(most.size(), max_keyframes));
  const int shared = std::accumulate(most.begin(), most.end(), 0,
                                     [](int sum, const auto& other) { return sum + other.shared_features; });
  std::vector<egraph::RelativePose> relative;
  for (const egraph::Covisibility& other : most) {
    const geometry::Pose first_from_world = map.keyframe(other.keyframe).world_from_camera.inverse();
    const egraph::Matrix6d to_first = adjoint(first_from_world);
    const double share = static_cast<double>(other.shared_features) / shared;
    const egraph::Matrix6d in_first = to_first * covariance * to_first.transpose() / share;
    relative.push_back({other.keyframe, id, first_from_world * map.keyframe(id).world_from_camera,
                        0.5 * (in_first + in_first.transpose())});
  }
  return relative;
}

}  // namespace eg::tracking
