#include "services/features_eval/frame_truth.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace eg::features_eval {
namespace {

using synthetic::SceneStructure;
using synthetic::Surface;

/// Index into structure.planes by surface.
std::vector<int> plane_of_surface(const SceneStructure& structure, std::size_t surfaces) {
  std::vector<int> result(surfaces, -1);
  for (std::size_t i = 0; i < structure.planes.size(); ++i) {
    for (const int surface : structure.planes[i].surfaces) {
      result[static_cast<std::size_t>(surface)] = static_cast<int>(i);
    }
  }
  return result;
}

cv::Mat plane_of_pixel(const cv::Mat& surface_of_pixel, const std::vector<int>& plane_of) {
  cv::Mat planes(surface_of_pixel.size(), CV_16SC1);
  std::transform(surface_of_pixel.begin<std::int16_t>(), surface_of_pixel.end<std::int16_t>(),
                 planes.begin<std::int16_t>(), [&](std::int16_t surface) {
                   const int plane = surface < 0 ? -1 : plane_of[static_cast<std::size_t>(surface)];
                   return static_cast<std::int16_t>(plane);
                 });
  return planes;
}

/// The axes of the surfaces in view, along which tiles, planks and bricks run, and those of painted rectangles.
std::vector<Eigen::Vector3d> painted_directions(const synthetic::Scene& scene, const cv::Mat& surface_of_pixel) {
  std::vector<char> seen(scene.surfaces.size(), 0);
  for (const auto surface : cv::Mat_<std::int16_t>(surface_of_pixel)) {
    if (surface >= 0) seen[static_cast<std::size_t>(surface)] = 1;
  }
  std::vector<Eigen::Vector3d> directions;
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
    if (seen[i] == 0) continue;
    const Surface& surface = scene.surfaces[i];
    directions.push_back(surface.axis_u);
    directions.push_back(surface.axis_v);
    for (const synthetic::Shape& shape : surface.material.shapes) {
      if (shape.disc) continue;
      const Eigen::Vector2d axis = shape.axis.cast<double>();
      directions.push_back(axis.x() * surface.axis_u + axis.y() * surface.axis_v);
      directions.push_back(axis.x() * surface.axis_v - axis.y() * surface.axis_u);
    }
  }
  return directions;
}

}  // namespace

FrameTruth frame_truth(const synthetic::SyntheticSequence& sequence, const SceneStructure& structure, int index,
                       const cv::Mat& depth) {
  const synthetic::Rendering rendering = sequence.render(index);
  const geometry::Pose world_from_camera = sequence.world_from_camera(index);
  const geometry::Pose camera_from_world = world_from_camera.inverse();
  const geometry::CameraModel& camera = sequence.options().camera;
  FrameTruth truth;
  truth.plane_of_pixel =
      plane_of_pixel(rendering.surface, plane_of_surface(structure, sequence.scene().surfaces.size()));
  truth.plane_of_pixel.setTo(-1, depth <= 0.0F);
  truth.plane_pixels.assign(structure.planes.size(), 0);
  for (const auto plane : cv::Mat_<std::int16_t>(truth.plane_of_pixel)) {
    if (plane >= 0) ++truth.plane_pixels[static_cast<std::size_t>(plane)];
  }
  for (const synthetic::TruePlane& plane : structure.planes) {
    truth.planes.push_back(geometry::transform(camera_from_world, plane.plane));
  }

  const double long_edge = FrameTruth::kLongEdge * std::hypot(camera.width, camera.height);
  const std::vector<double> lengths = synthetic::visible_lengths(structure, rendering, camera, world_from_camera);
  std::vector<int> long_edges(structure.directions.size(), 0);
  std::vector<double> visible(structure.directions.size(), 0.0);
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const auto direction = static_cast<std::size_t>(structure.edges[i].direction);
    visible[direction] += lengths[i];
    if (lengths[i] >= long_edge) ++long_edges[direction];
  }
  for (std::size_t i = 0; i < structure.directions.size(); ++i) {
    const Eigen::Vector3d direction = camera_from_world.rotation * structure.directions[i];
    if (long_edges[i] >= FrameTruth::kGroupEdges) truth.parallel_groups.push_back(direction);
    if (visible[i] > 0.0) truth.directions.push_back(direction);
  }
  for (const Eigen::Vector3d& direction : painted_directions(sequence.scene(), rendering.surface)) {
    truth.directions.push_back(camera_from_world.rotation * direction);
  }
  return truth;
}

}  // namespace eg::features_eval
