#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/geometry/plane.hpp"
#include "common/geometry/pose.hpp"
#include "common/synthetic/scene.hpp"

namespace eg::synthetic {

/// The faces of a box by the axes of its frame: the front is -y, x runs to the right seen from the front, z up.
enum Face : unsigned { kFront = 1, kBack = 2, kLeft = 4, kRight = 8, kTop = 16, kBottom = 32 };

/// The faces to see of a box that stands on the floor, stands there with its back to a wall, or hangs on a wall.
inline constexpr unsigned kStanding = kFront | kBack | kLeft | kRight | kTop;
inline constexpr unsigned kAgainstWall = kFront | kLeft | kRight | kTop;
inline constexpr unsigned kHanging = kAgainstWall | kBottom;
inline constexpr unsigned kAllFaces = kStanding | kBottom;

/// A frame on the floor at (x, y), turned by `yaw` radians: yaw 0 has its front towards the world's -y.
geometry::Pose standing_at(double x, double y, double yaw);

/// A frame on a surface at (u, v): x along u, z along v, the front (-y) towards the viewer.
geometry::Pose mounted_at(const Surface& surface, double u, double v);

/// Puts simple bodies together to a scene.
class SceneBuilder {
 public:
  /// A box from `low` to `high` in a frame. `front` paints the front face, `rest` the others.
  void box(const geometry::Pose& world_from_frame, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
           unsigned faces, const Material& rest, const Material& front);
  void box(const geometry::Pose& world_from_frame, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
           unsigned faces, const Material& material) {
    box(world_from_frame, low, high, faces, material, material);
  }

  /// The inside of the convex body {p : every plane's signed distance >= 0}; materials in the order of the planes.
  /// Returns the index of the first surface; one follows for every plane. Upright surfaces have v upwards.
  std::size_t interior(std::span<const geometry::Plane> planes, std::span<const Material> materials);

  /// A frame of four bars around an opening of `width` x `height` whose lower left corner is the frame's origin.
  void moulding(const geometry::Pose& world_from_frame, double width, double height, double bar, double thickness,
                const Material& material, bool with_sill);

  /// A bar along the foot of an upright surface.
  void skirting(std::size_t wall, double height, double thickness, const Material& material);

  [[nodiscard]] const Surface& surface(std::size_t index) const { return scene_.surfaces[index]; }
  void lamp(const Lamp& lamp) { scene_.lamps.push_back(lamp); }
  [[nodiscard]] Scene take() { return std::move(scene_); }

 private:
  Scene scene_;
};

}  // namespace eg::synthetic
