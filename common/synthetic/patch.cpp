#include "common/synthetic/patch.hpp"

#include <algorithm>

namespace eg::synthetic {
namespace {

struct Range {
  double low;
  double high;
};

Range range_over(const RayFunction& f, const RayBox& box) {
  const double middle = evaluate(f, box.centre);
  const double spread = std::abs(f.x()) * box.half_size.x() + std::abs(f.y()) * box.half_size.y();
  return {middle - spread, middle + spread};
}

}  // namespace

std::vector<Patch> visible_patches(const Scene& scene, const geometry::Pose& world_from_camera) {
  const geometry::Pose camera_from_world = world_from_camera.inverse();
  std::vector<Patch> patches;
  for (std::size_t index = 0; index < scene.surfaces.size(); ++index) {
    const Surface& surface = scene.surfaces[index];
    const geometry::Plane plane = geometry::transform(camera_from_world, surface.plane());
    if (plane.distance <= 1e-9) continue;  // seen from behind, or edge on
    Patch patch;
    patch.surface = static_cast<int>(index);
    patch.inverse_depth = -plane.normal / plane.distance;
    patch.normal = plane.normal;
    patch.side_count = surface.outline.size();
    for (std::size_t i = 0; i < patch.side_count; ++i) {
      const Eigen::Vector3d from = camera_from_world * surface.point(surface.outline[i]);
      const Eigen::Vector3d to = camera_from_world * surface.point(surface.outline[(i + 1) % patch.side_count]);
      patch.sides[i] = to.cross(from);  // normal of the plane through the camera and this side, towards the inside
    }
    const Eigen::Vector3d from_origin = world_from_camera.translation - surface.origin;
    patch.u = camera_from_world.rotation * surface.axis_u;
    patch.v = camera_from_world.rotation * surface.axis_v;
    patch.u_origin = surface.axis_u.dot(from_origin);
    patch.v_origin = surface.axis_v.dot(from_origin);
    patches.push_back(patch);
  }
  return patches;
}

void patches_in_box(const std::vector<Patch>& patches, const RayBox& box, std::vector<const Patch*>& found) {
  found.clear();
  double nearest_filling = 0.0;  // largest inverse depth that one patch guarantees all over the box
  for (const Patch& patch : patches) {
    const Range inverse_depth = range_over(patch.inverse_depth, box);
    if (inverse_depth.high <= nearest_filling) continue;
    bool fills = true;
    bool outside = false;
    for (std::size_t i = 0; i < patch.side_count && !outside; ++i) {
      const Range side = range_over(patch.sides[i], box);
      outside = side.high < 0.0;
      fills = fills && side.low >= 0.0;
    }
    if (outside) continue;
    found.push_back(&patch);
    if (fills) nearest_filling = std::max(nearest_filling, inverse_depth.low);
  }
  std::erase_if(found,
                [&](const Patch* patch) { return range_over(patch->inverse_depth, box).high < nearest_filling; });
}

}  // namespace eg::synthetic
