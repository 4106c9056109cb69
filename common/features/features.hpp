#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/geometry/plane.hpp"
#include "common/image/rgbd_frame.hpp"

namespace eg::features {

using Descriptor = std::array<std::uint8_t, 32>;

/// An ORB corner with its depth, if the depth image has one there.
struct PointFeature {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< undistorted
  double pixel_sigma = 1.0;                         ///< standard deviation per axis, pixels; grows with the pyramid level
  double depth = 0.0;                               ///< z, metres; 0: none
  double depth_sigma = 0.0;                         ///< metres
  double angle = 0.0;                               ///< orientation in the image, radians
  int octave = 0;                                   ///< pyramid level it was found on
  Descriptor descriptor{};                          ///< rotated BRIEF, 256 bits
  std::int32_t track_id = -1;                       ///< known correspondence of feature-level data; -1: unknown

  [[nodiscard]] bool has_depth() const { return depth > 0.0; }
};

/// A straight segment in the image and, where depth supports it, in space.
struct LineFeature {
  Eigen::Vector2d start_pixel = Eigen::Vector2d::Zero();  ///< undistorted
  Eigen::Vector2d end_pixel = Eigen::Vector2d::Zero();
  bool has_depth = false;                           ///< whether the fields in space below are valid
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< end points in the camera frame, metres, on the fitted 3D line
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  Eigen::Matrix3d start_covariance = Eigen::Matrix3d::Zero();  ///< of the end points, m²
  Eigen::Matrix3d end_covariance = Eigen::Matrix3d::Zero();
  Descriptor descriptor{};     ///< appearance beside the segment, compared by Hamming distance
  std::int32_t direction = -1;  ///< index into FrameFeatures::directions of its group; -1: none
  std::int32_t track_id = -1;   ///< known correspondence of feature-level data; -1: unknown

  [[nodiscard]] double length_pixels() const { return (end_pixel - start_pixel).norm(); }
};

/// A planar region of the depth image.
struct PlaneFeature {
  geometry::Plane plane;  ///< in the camera frame, normal towards the camera (distance > 0)
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< of (normal, distance); rank 3, zero along the normal
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();    ///< of its pixels' points, metres
  std::int32_t support = 0;                              ///< pixels that belong to it
  std::vector<Eigen::Vector3d> hull;  ///< convex hull on the plane, camera frame, metres; at most kMaxHullPoints
};

enum class DirectionKind : std::uint8_t {
  plane_normal = 0,         ///< of PlaneFeature `source`, towards the camera
  vanishing_direction = 1,  ///< VD: of two or more parallel lines
  potential_direction = 2,  ///< PD: of one single 3D line, `source`
};

/// A scene direction seen in one frame: what the E-Graph is made of (paper, section 4.1). Its sign is arbitrary for
/// vanishing and potential directions.
struct DirectionFeature {
  DirectionKind kind = DirectionKind::plane_normal;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit vector in the camera frame
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< rad², tangential: covariance · direction = 0
  std::int32_t support = 0;                              ///< pixels of the plane or lines of the group
  std::int32_t source = -1;  ///< index into planes (plane_normal) or lines (potential_direction); -1 for groups
};

/// Bounds on one frame's features. Extractors keep the strongest; decoders refuse more.
inline constexpr int kMaxPoints = 4000;
inline constexpr int kMaxLines = 1000;
inline constexpr int kMaxPlanes = 64;
inline constexpr int kMaxDirections = 512;
inline constexpr int kMaxHullPoints = 32;

/// Everything the tracker needs of one frame. It holds no pixels.
struct FrameFeatures {
  image::FrameHeader header;
  geometry::CameraModel camera;  ///< without distortion
  std::vector<PointFeature> points;
  std::vector<LineFeature> lines;
  std::vector<PlaneFeature> planes;
  std::vector<DirectionFeature> directions;
};

}  // namespace eg::features
