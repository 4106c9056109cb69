#include "common/observations/visible_part.hpp"

#include <Eigen/Geometry>

namespace eg::observations {
namespace {

constexpr double kMargin = 2.0;  // pixels

/// Cuts away what is not in the half space normal · p >= offset. False if nothing is left.
bool clip(Segment3& segment, const Eigen::Vector3d& normal, double offset) {
  const double at_start = normal.dot(segment.start) - offset;
  const double at_end = normal.dot(segment.end) - offset;
  if (at_start < 0.0 && at_end < 0.0) return false;
  const Eigen::Vector3d span = segment.end - segment.start;
  if (at_start < 0.0) segment.start += at_start / (at_start - at_end) * span;
  if (at_end < 0.0) segment.end -= at_end / (at_end - at_start) * span;
  return true;
}

}  // namespace

std::optional<Segment3> visible_part(Segment3 segment, const geometry::CameraModel& camera, double nearest,
                                     double furthest) {
  if (!clip(segment, Eigen::Vector3d::UnitZ(), nearest)) return std::nullopt;
  if (!clip(segment, -Eigen::Vector3d::UnitZ(), -furthest)) return std::nullopt;
  const double right = camera.width - 1.0 - kMargin;
  const double bottom = camera.height - 1.0 - kMargin;
  const Eigen::Vector2d corners[] = {{kMargin, kMargin}, {right, kMargin}, {right, bottom}, {kMargin, bottom}};
  const Eigen::Vector3d middle = camera.ray({0.5 * camera.width, 0.5 * camera.height});
  for (int side = 0; side < 4; ++side) {
    Eigen::Vector3d inwards = camera.ray(corners[side]).cross(camera.ray(corners[(side + 1) % 4]));
    if (inwards.dot(middle) < 0.0) inwards = -inwards;
    if (!clip(segment, inwards, 0.0)) return std::nullopt;
  }
  return segment;
}

}  // namespace eg::observations
