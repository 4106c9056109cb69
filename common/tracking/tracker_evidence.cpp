#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "common/egraph/rotation_solver.hpp"
#include "common/tracking/pose_covariance.hpp"
#include "common/tracking/tracker_frame.hpp"
#include "common/tracking/visibility.hpp"

/// What speaks for a pose and what against it.
namespace eg::tracking {
namespace {

bool all_parallel(const std::vector<Eigen::Vector3d>& normals) {
  return std::all_of(normals.begin(), normals.end(), [&](const Eigen::Vector3d& normal) {
    return std::abs(normal.dot(normals.front())) > std::cos(egraph::kMinAngleBetweenDirections);
  });
}

}  // namespace

bool Tracker::is_proven(const Frame& frame) const {
  const auto named =
      std::count_if(frame.matches.points.begin(), frame.matches.points.end(), [&](const PointMatch& match) {
        return frame.features.points[static_cast<std::size_t>(match.feature)].track_id >= 0;
      });
  return frame.solution.inlier_points() >= options_.min_points_without_planes || named >= options_.min_named_points ||
         frame.solution.inlier_planes() > 0 || frame.solution.inlier_lines() >= options_.min_lines_without_planes;
}

bool Tracker::goes_on_as_before(const Frame& frame) const {
  const Matrix6d covariance = camera_covariance(frame.solution.information, frame.prediction);
  return !lost_ && is_proven(frame) &&
         MotionPrior{frame.camera_from_world, covariance}.rotation_sigma() < options_.max_rotation_sigma;
}

bool Tracker::follows_one_wall(const Frame& frame, const Observability& observed) const {
  return !lost_ && frame.solution.inlier_planes() > 0 && observed.second_rotation_sigma < options_.max_rotation_sigma &&
         motion_.unseen_turn_sigma() < options_.max_unseen_turn;
}

bool Tracker::planes_are_unmistakable(const Frame& frame) const {
  return !lost_ && 3.0 * frame.prediction.rotation_sigma() < options_.search.max_plane_angle &&
         3.0 * frame.prediction.translation_sigma() < options_.search.max_plane_distance;
}

bool Tracker::tells_pose(const features::FrameFeatures& features) const {
  const auto points = std::count_if(features.points.begin(), features.points.end(),
                                    [](const auto& point) { return point.has_depth(); });
  const auto lines =
      std::count_if(features.lines.begin(), features.lines.end(), [](const auto& line) { return line.has_depth; });
  std::vector<Eigen::Vector3d> normals;
  for (const features::PlaneFeature& plane : features.planes) normals.push_back(plane.plane.normal);
  return points >= options_.min_points_without_planes || lines >= options_.min_lines_without_planes ||
         !all_parallel(normals);
}

bool Tracker::map_tells_no_pose() const {
  const auto has_fewer = [](const auto& landmarks, int count) { return std::ssize(landmarks) < count; };
  if (!has_fewer(map_.points(), options_.min_points_without_planes)) return false;
  if (!has_fewer(map_.lines(), options_.min_lines_without_planes)) return false;
  std::vector<Eigen::Vector3d> normals;
  for (const MapPlane& plane : map_.planes()) normals.push_back(plane.estimate.plane.normal);
  return all_parallel(normals);
}

bool Tracker::directions_are_unmistakable(const Frame& frame) const {
  return 3.0 * frame.prediction.rotation_sigma() < options_.max_turn_of_directions;
}

bool Tracker::misses_expected_points(const Frame& frame) const {
  const auto expected = visible_points(frame.features.camera, map_, frame.near_points, frame.camera_from_world);
  const auto possible = static_cast<int>(std::min(expected.size(), frame.features.points.size()));
  // Whoever is lost may be anywhere: as many have to agree as at any known place, or half where there are few.
  const int enough = lost_ ? std::min(options_.relocaliser.min_inliers, possible / 2) : 0;
  return possible >= options_.min_expected_points &&
         frame.solution.inlier_points() < std::max(enough, options_.min_points_without_planes);
}

bool Tracker::points_contradict(const Frame& frame) const {
  return !planes_are_unmistakable(frame) && misses_expected_points(frame);
}

int Tracker::found(const Frame& frame) const { return frame.solution.inlier_points() + frame.solution.inlier_lines(); }

bool Tracker::finds_much_less(const Frame& frame) const { return 2 * found(frame) < last_found_; }

bool Tracker::is_doubtful(const Frame& frame) const {
  return finds_much_less(frame) || (planes_are_unmistakable(frame) && leads_away(frame));
}

bool Tracker::leads_away(const Frame& frame) const {
  const bool misses_planes = 2 * frame.solution.inlier_planes() < static_cast<int>(frame.features.planes.size());
  return misses_planes || misses_expected_points(frame);
}

}  // namespace eg::tracking
