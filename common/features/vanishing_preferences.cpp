#include "common/features/vanishing_preferences.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "common/base/check.hpp"
#include "common/base/random.hpp"

namespace eg::features {
namespace {

constexpr double kMinPlaneAngle = 0.005;  // radians between two segments' planes; less: one line, no intersection

/// The homogeneous image of a direction, (x, y, w): w is 0 for a direction parallel to the image.
Eigen::Vector3d image_of(const Eigen::Vector3d& direction, const geometry::CameraModel& camera) {
  return {camera.fx * direction.x() + camera.cx * direction.z(), camera.fy * direction.y() + camera.cy * direction.z(),
          direction.z()};
}

/// Squared distance of the ends from the line through the middle and `point`, as a fraction without a division: that
/// line's direction is point - w * middle, at any w.
struct SquaredError {
  double numerator;
  double denominator;

  [[nodiscard]] bool at_most(double error) const {
    return denominator > 0.0 && numerator <= error * error * denominator;
  }
};

SquaredError error_to(const DirectionalSegment& segment, const Eigen::Vector3d& point) {
  const double dx = point.x() - point.z() * segment.middle.x();
  const double dy = point.y() - point.z() * segment.middle.y();
  const double cross = dx * segment.half.y() - dy * segment.half.x();
  return {cross * cross, dx * dx + dy * dy};
}

std::vector<Eigen::Vector3d> draw_hypotheses(const std::vector<DirectionalSegment>& segments,
                                             const geometry::CameraModel& camera, int count, std::uint64_t seed) {
  base::Random random(seed);
  const int segment_count = static_cast<int>(segments.size());
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const auto& a = segments[static_cast<std::size_t>(random.index(segment_count))];
    const auto& b = segments[static_cast<std::size_t>(random.index(segment_count))];
    const Eigen::Vector3d direction = a.plane_normal.cross(b.plane_normal);
    if (direction.norm() > kMinPlaneAngle) points.push_back(image_of(direction.normalized(), camera));
  }
  return points;
}

}  // namespace

DirectionalSegment directional(const Segment& segment, const geometry::CameraModel& camera) {
  return {camera.ray(segment.start).cross(camera.ray(segment.end)).normalized(), segment.at(0.5),
          0.5 * (segment.end - segment.start)};
}

double vanishing_error(const DirectionalSegment& segment, const Eigen::Vector3d& direction,
                       const geometry::CameraModel& camera) {
  const SquaredError error = error_to(segment, image_of(direction, camera));
  return error.denominator > 0.0 ? std::sqrt(error.numerator / error.denominator) : segment.half.norm();
}

std::vector<PreferenceSet> preference_sets(const std::vector<DirectionalSegment>& segments,
                                           const geometry::CameraModel& camera, int hypotheses, double max_error,
                                           std::uint64_t seed) {
  EG_CHECK(hypotheses <= kMaxHypotheses, "a preference set has room for every hypothesis");
  std::vector<PreferenceSet> sets(segments.size(), PreferenceSet{});
  if (segments.empty()) return sets;
  const std::vector<Eigen::Vector3d> points = draw_hypotheses(segments, camera, hypotheses, seed);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) {
      const bool agrees = error_to(segments[i], points[j]).at_most(max_error);
      sets[i][j / 64] |= std::uint64_t{agrees} << (j % 64);
    }
  }
  return sets;
}

}  // namespace eg::features
