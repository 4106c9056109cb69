#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "common/geometry/pose.hpp"
#include "common/synthetic/scene.hpp"

namespace eg::synthetic {

/// A function a + b x + c y of the ray (x, y, 1).
using RayFunction = Eigen::Vector3d;

inline double evaluate(const RayFunction& f, const Eigen::Vector2d& ray) {
  return f.x() * ray.x() + f.y() * ray.y() + f.z();
}

/// A rectangle of rays: a tile of the image.
struct RayBox {
  Eigen::Vector2d centre;
  Eigen::Vector2d half_size;
};

/// A surface as one camera pose sees it, in functions that are linear in the ray, so that neither perspective division
/// nor clipping against the camera plane is needed (homogeneous scan conversion: Olano and Greer, Graphics Hardware
/// 1997).
struct Patch {
  int surface = -1;
  RayFunction inverse_depth;                            ///< 1/z of the plane, 1/m
  std::array<RayFunction, Surface::kMaxCorners> sides;  ///< all >= 0: the ray meets the polygon
  std::size_t side_count = 0;
  RayFunction u, v;  ///< position on the surface: z evaluate(u, ray) + u_origin
  double u_origin = 0.0;
  double v_origin = 0.0;
  Eigen::Vector3d normal;  ///< in the camera frame

  [[nodiscard]] bool covers(const Eigen::Vector2d& ray) const {
    for (std::size_t i = 0; i < side_count; ++i) {
      if (evaluate(sides[i], ray) < 0.0) return false;
    }
    return true;
  }
};

/// The surfaces whose front the camera sees.
std::vector<Patch> visible_patches(const Scene& scene, const geometry::Pose& world_from_camera);

/// The patches that may be seen somewhere within `box`: those outside it, and those wholly behind a patch that fills
/// it, are left out. Order is kept. `found` is overwritten.
void patches_in_box(const std::vector<Patch>& patches, const RayBox& box, std::vector<const Patch*>& found);

/// The patch nearest to the camera along the ray, or null.
inline const Patch* nearest_patch(const std::vector<const Patch*>& patches, const Eigen::Vector2d& ray) {
  const Patch* nearest = nullptr;
  double largest = 0.0;
  for (const Patch* patch : patches) {
    const double inverse_depth = evaluate(patch->inverse_depth, ray);
    if (inverse_depth > largest && patch->covers(ray)) {
      largest = inverse_depth;
      nearest = patch;
    }
  }
  return nearest;
}

}  // namespace eg::synthetic
