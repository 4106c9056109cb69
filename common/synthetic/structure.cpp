#include "common/synthetic/structure.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/so3.hpp"
#include "common/synthetic/pixel_rays.hpp"

namespace eg::synthetic {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSameAngle = 1e-4;     // radians
constexpr double kSameDistance = 1e-4;  // metres

/// Index of the first element that `same` accepts; appends `fresh` if there is none.
template <typename T, typename Predicate>
int find_or_append(std::vector<T>& list, const T& fresh, const Predicate& same) {
  const auto it = std::find_if(list.begin(), list.end(), same);
  if (it != list.end()) return static_cast<int>(it - list.begin());
  list.push_back(fresh);
  return static_cast<int>(list.size()) - 1;
}

void add_plane(SceneStructure& structure, const geometry::Plane& plane, int surface) {
  const int index = find_or_append(structure.planes, TruePlane{plane, {}}, [&](const TruePlane& known) {
    return (known.plane.normal - plane.normal).norm() < kSameAngle &&
           std::abs(known.plane.distance - plane.distance) < kSameDistance;
  });
  structure.planes[static_cast<std::size_t>(index)].surfaces.push_back(surface);
}

void add_edge(SceneStructure& structure, const Vector3d& start, const Vector3d& end) {
  const auto near = [](const Vector3d& a, const Vector3d& b) { return (a - b).norm() < kSameDistance; };
  const bool known = std::any_of(structure.edges.begin(), structure.edges.end(), [&](const TrueEdge& edge) {
    return (near(edge.start, start) && near(edge.end, end)) || (near(edge.start, end) && near(edge.end, start));
  });
  if (known) return;
  const Vector3d direction = (end - start).normalized();
  const int index = find_or_append(structure.directions, direction, [&](const Vector3d& other) {
    return geometry::axial_angle(direction, other) < kSameAngle;
  });
  structure.edges.push_back({start, end, index});
}

/// Whether a point in the camera frame is what the rendering shows at one of the pixels around it.
bool is_seen(const Vector3d& point, const Vector2d& pixel, const Rendering& rendering) {
  const auto left = static_cast<int>(std::floor(pixel.x()));
  const auto top = static_cast<int>(std::floor(pixel.y()));
  for (int y = std::max(top, 0); y <= std::min(top + 1, rendering.depth.rows - 1); ++y) {
    for (int x = std::max(left, 0); x <= std::min(left + 1, rendering.depth.cols - 1); ++x) {
      if (std::abs(rendering.depth.at<float>(y, x) - point.z()) < 0.01 * point.z()) return true;
    }
  }
  return false;
}

double visible_length(const TrueEdge& edge, const Rendering& rendering, const geometry::CameraModel& camera,
                      const geometry::Pose& camera_from_world) {
  constexpr double kStep = 0.02;  // metres
  const int steps = std::max(1, static_cast<int>(std::ceil((edge.end - edge.start).norm() / kStep)));
  double length = 0.0;
  Vector2d last_pixel = Vector2d::Zero();
  bool last_seen = false;
  for (int i = 0; i <= steps; ++i) {
    const Vector3d point = camera_from_world * (edge.start + (edge.end - edge.start) * i / steps);
    bool seen = point.z() > 1e-3;
    Vector2d pixel = Vector2d::Zero();
    if (seen) {
      pixel = distorted_pixel(camera, point.hnormalized());
      seen = camera.contains(pixel) && is_seen(point, pixel, rendering);
    }
    if (seen && last_seen) length += (pixel - last_pixel).norm();
    last_pixel = pixel;
    last_seen = seen;
  }
  return length;
}

}  // namespace

SceneStructure structure_of(const Scene& scene) {
  SceneStructure structure;
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
    const Surface& surface = scene.surfaces[i];
    add_plane(structure, surface.plane(), static_cast<int>(i));
    for (std::size_t k = 0; k < surface.outline.size(); ++k) {
      const auto& next = surface.outline[(k + 1) % surface.outline.size()];
      add_edge(structure, surface.point(surface.outline[k]), surface.point(next));
    }
  }
  return structure;
}

std::vector<double> visible_lengths(const SceneStructure& structure, const Rendering& rendering,
                                    const geometry::CameraModel& camera, const geometry::Pose& world_from_camera) {
  const geometry::Pose camera_from_world = world_from_camera.inverse();
  std::vector<double> lengths;
  for (const TrueEdge& edge : structure.edges) {
    lengths.push_back(visible_length(edge, rendering, camera, camera_from_world));
  }
  return lengths;
}

}  // namespace eg::synthetic
