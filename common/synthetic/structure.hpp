#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/geometry/plane.hpp"
#include "common/geometry/pose.hpp"
#include "common/synthetic/renderer.hpp"
#include "common/synthetic/scene.hpp"

namespace eg::synthetic {

/// Surfaces of one plane.
struct TruePlane {
  geometry::Plane plane;      ///< world
  std::vector<int> surfaces;  ///< indices into Scene::surfaces
};

/// A straight edge between surfaces, or the rim of one.
struct TrueEdge {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< world, metres
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  int direction = -1;  ///< index into SceneStructure::directions
};

/// What estimators should find in a scene: planes, edges, and the directions of parallel edges.
struct SceneStructure {
  std::vector<TruePlane> planes;
  std::vector<TrueEdge> edges;
  std::vector<Eigen::Vector3d> directions;  ///< unit vectors; the sign means nothing
};

/// The structure of the geometry; edges within textures (joints of tiles and the like) are not part of it.
SceneStructure structure_of(const Scene& scene);

/// The visible length in pixels of each edge; as long as structure.edges. An edge is seen where its points are as deep
/// as the rendering around them.
std::vector<double> visible_lengths(const SceneStructure& structure, const Rendering& rendering,
                                    const geometry::CameraModel& camera, const geometry::Pose& world_from_camera);

}  // namespace eg::synthetic
