#pragma once

#include <vector>

#include "common/tracking/map.hpp"

/// Frames and maps made by hand for the matchers' tests.
namespace eg::tracking {

using Eigen::Vector2d;
using Eigen::Vector3d;
using features::Descriptor;
using features::FrameFeatures;
using features::LineFeature;
using features::PlaneFeature;
using features::PointFeature;
using geometry::Pose;

inline const geometry::CameraModel kCamera = *geometry::find_camera("tum_fr3");

/// A descriptor that differs in `bits` bits from zero, starting at bit `from`.
inline Descriptor with_bits(int bits, int from = 0) {
  Descriptor descriptor{};
  for (int bit = from; bit < from + bits; ++bit) {
    auto& byte = descriptor[static_cast<std::size_t>(bit / 8)];
    byte = static_cast<std::uint8_t>(byte | (1 << (bit % 8)));
  }
  return descriptor;
}

inline PointFeature point_at(const Vector2d& pixel, const Descriptor& descriptor, double depth = 2.0, int octave = 0) {
  PointFeature point;
  point.pixel = pixel;
  point.depth = depth;
  point.depth_sigma = 0.01;
  point.octave = octave;
  point.descriptor = descriptor;
  return point;
}

inline FrameFeatures frame_of(const std::vector<PointFeature>& points) {
  FrameFeatures frame;
  frame.camera = kCamera;
  frame.points = points;
  return frame;
}

inline Map map_of(const FrameFeatures& frame) {
  Map map;
  map.add_keyframe(frame, Pose{}, {});
  return map;
}

inline std::vector<PointId> all_points(const Map& map) {
  std::vector<PointId> ids;
  for (const MapPoint& point : map.points()) ids.push_back(point.id);
  return ids;
}

inline std::vector<LineId> all_lines(const Map& map) {
  std::vector<LineId> ids;
  for (const MapLine& line : map.lines()) ids.push_back(line.id);
  return ids;
}

}  // namespace eg::tracking
