#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace eg::eval {

/// A mesh (or, without triangles, a cloud of points) that belongs to somebody else.
struct SurfaceView {
  std::span<const Eigen::Vector3f> vertices;                     ///< metres
  std::span<const std::array<std::uint32_t, 3>> triangles = {};  ///< indices into vertices
};

/// A point of a surface that stands for the area around it.
struct SurfaceSample {
  Eigen::Vector3f point;
  float area = 0.0F;  ///< m²; 1 for every point of a cloud
};

/// The points of a cloud, or points that cover the triangles evenly: each triangle is cut into n² equal ones with edges
/// of at most `spacing` metres (n at most 1000), each of which gives its centre; one without area gives nothing.
struct SurfaceSamples {
  std::vector<SurfaceSample> samples;
  std::vector<std::uint32_t> triangle;  ///< which triangle a sample lies on; empty for clouds
};
SurfaceSamples sample_surface(const SurfaceView& surface, double spacing);

/// The distance in metres from a point to the nearest point of a triangle (Ericson, Real-Time Collision Detection,
/// 2005, section 5.1.5).
float distance_to_triangle(const Eigen::Vector3f& point, const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                           const Eigen::Vector3f& c);

}  // namespace eg::eval
