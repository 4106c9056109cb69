#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/base/random.hpp"
#include "common/features/features.hpp"
#include "common/geometry/plane.hpp"
#include "common/geometry/pose.hpp"

/// Scenes known exactly at the level of features, and cameras that see them with known noise: what a tracker needs of a
/// frame without rendering and extracting it.
namespace eg::test {

/// A rectangle centre + a * half_u + b * half_v, |a|, |b| <= 1. Its normal points into the room.
struct WorldWall {
  Eigen::Vector3d centre, half_u, half_v, normal;
  [[nodiscard]] geometry::Plane plane() const { return {normal, -normal.dot(centre)}; }
};

struct WorldCorner {
  Eigen::Vector3d position;
  features::Descriptor descriptor;
};

struct WorldLine {
  Eigen::Vector3d start, end;
  features::Descriptor descriptor;
};

struct FeatureWorld {
  std::vector<WorldWall> walls;
  std::vector<WorldCorner> corners;
  std::vector<WorldLine> lines;
};

struct RoomOptions {
  Eigen::Vector3d half_size = {2.5, 1.3, 2.5};  ///< metres; y is height
  int corners_per_wall = 120;
  bool lines = true;  ///< the room's twelve edges and two boards with slanted sides
  Eigen::Matrix3d orientation = Eigen::Matrix3d::Identity();
  std::uint64_t seed = 1;
};

/// A box seen from inside, centred at the origin.
FeatureWorld make_room(const RoomOptions& options = {});

/// How a camera disturbs what it sees; the same figures are the covariances that it reports.
struct SensorNoise {
  bool disturb = true;            ///< false: exact measurements, the covariances as below
  bool identities = false;        ///< points and lines carry their numbers in the world as track ids
  double pixel = 0.5;             ///< pixels, on the finest pyramid level
  double descriptor_flip = 0.03;  ///< probability per bit
  double missing = 0.1;           ///< share of points that the detector overlooks
  double line_end = 0.003;        ///< metres, of end points in space
  double plane_tilt = 0.002;      ///< radians
  double plane_height = 0.001;    ///< metres, at the centroid
  double direction = 0.003;       ///< radians, of vanishing and potential directions
};

/// What the camera at `world_from_camera` sees: points with depth, lines, planes, directions.
features::FrameFeatures observe(const FeatureWorld& world, const geometry::CameraModel& camera,
                                const geometry::Pose& world_from_camera, const image::FrameHeader& header,
                                base::Random& random, const SensorNoise& noise = {});

/// A recording of a world: one frame per pose, 30 per second, with the exact poses.
struct FeatureSequence {
  std::vector<features::FrameFeatures> frames;
  std::vector<geometry::Pose> world_from_camera;  ///< relative to the first camera, as the tracker's world
};

FeatureSequence record(const FeatureWorld& world, const geometry::CameraModel& camera,
                       const std::vector<geometry::Pose>& world_from_camera, std::uint64_t seed,
                       const SensorNoise& noise = {});

/// The camera at `position` looking at `target`, y down (or up, for a camera of negative fy).
geometry::Pose looking_at(const Eigen::Vector3d& position, const Eigen::Vector3d& target,
                          const geometry::CameraModel& camera);

}  // namespace eg::test
