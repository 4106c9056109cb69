#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "common/egraph/association.hpp"
#include "common/egraph/types.hpp"
#include "common/features/features.hpp"
#include "common/geometry/plane.hpp"
#include "common/geometry/pose.hpp"
#include "common/tracking/plane_estimate.hpp"
#include "common/tracking/spatial_index.hpp"

namespace eg::tracking {

using egraph::KeyframeId;
/// Scale between two levels of the point extractor's pyramid.
inline constexpr double kPyramidScale = 1.2;

using PointId = base::Id<struct PointTag>;
using LineId = base::Id<struct LineTag>;
using PlaneId = base::Id<struct PlaneTag>;

/// How often a feature was expected in a frame and how often it was found there.
struct Visibility {
  std::int32_t expected = 0;
  std::int32_t found = 0;
};

/// A corner in space.
struct MapPoint {
  PointId id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< world, metres
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();    ///< m²
  Eigen::Vector3d viewed_from = Eigen::Vector3d::UnitZ();  ///< unit vector from the point to the camera that made it
  double reference_distance = 1.0;                         ///< metres from which it was seen on octave 0
  features::Descriptor descriptor{};
  std::int32_t track_id = -1;
  KeyframeId first_seen;
  std::int32_t observations = 0;
  Visibility visibility;
  bool alive = true;
};

/// A straight segment in space.
struct MapLine {
  LineId id;
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< world, metres
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  Eigen::Matrix3d start_covariance = Eigen::Matrix3d::Zero();  ///< m²
  Eigen::Matrix3d end_covariance = Eigen::Matrix3d::Zero();
  Eigen::Vector3d viewed_from = Eigen::Vector3d::UnitZ();  ///< unit vector from its middle to the camera that made it
  features::Descriptor descriptor{};
  std::int32_t track_id = -1;
  KeyframeId first_seen;
  std::int32_t observations = 0;
  Visibility visibility;
  bool alive = true;
};

/// A border-less plane in space.
struct MapPlane {
  PlaneId id;
  PlaneEstimate estimate;  ///< world
  KeyframeId first_seen;
  std::int32_t observations = 0;
};

/// A feature of a frame and the map feature it is a view of.
template <typename MapId>
struct Match {
  std::int32_t feature = -1;  ///< index into FrameFeatures
  MapId id;
};
using PointMatch = Match<PointId>;
using LineMatch = Match<LineId>;
using PlaneMatch = Match<PlaneId>;

struct Matches {
  std::vector<PointMatch> points;
  std::vector<LineMatch> lines;
  std::vector<PlaneMatch> planes;
};

/// A keyframe as the tracker remembers it: its features and what they turned out to be.
struct MapKeyframe {
  KeyframeId id;
  features::FrameFeatures features;
  geometry::Pose world_from_camera;
  Matches matches;
  std::vector<egraph::Association> directions;  ///< of features.directions: the landmarks of the graph that they show
};

/// A keyframe that saw a landmark, and as which of its features.
struct Observer {
  KeyframeId keyframe;
  std::int32_t feature = -1;
};

/// The sparse map: points, lines and planes with covariances, and the keyframes that saw them. Ids index the arrays;
/// what was culled stays as a dead entry, so that an id never changes its meaning.
class Map {
 public:
  /// Adds a keyframe: its matches fuse into what they matched, its other features that have depth become new map
  /// features.
  KeyframeId add_keyframe(const features::FrameFeatures& features, const geometry::Pose& world_from_camera,
                          const Matches& matches, std::span<const egraph::Association> directions = {});

  [[nodiscard]] std::span<const MapPoint> points() const { return points_; }
  [[nodiscard]] std::span<const MapLine> lines() const { return lines_; }
  [[nodiscard]] std::span<const MapPlane> planes() const { return planes_; }
  [[nodiscard]] std::span<const MapKeyframe> keyframes() const { return keyframes_; }
  [[nodiscard]] const MapPoint& point(PointId id) const { return points_[static_cast<std::size_t>(id.value)]; }
  [[nodiscard]] const MapLine& line(LineId id) const { return lines_[static_cast<std::size_t>(id.value)]; }
  [[nodiscard]] const MapPlane& plane(PlaneId id) const { return planes_[static_cast<std::size_t>(id.value)]; }
  [[nodiscard]] const MapKeyframe& keyframe(KeyframeId id) const {
    return keyframes_[static_cast<std::size_t>(id.value)];
  }
  [[nodiscard]] bool empty() const { return keyframes_.empty(); }

  /// Who saw a landmark, oldest keyframe first.
  [[nodiscard]] std::span<const Observer> observers(PointId id) const {
    return point_observers_[static_cast<std::size_t>(id.value)];
  }
  [[nodiscard]] std::span<const Observer> observers(LineId id) const {
    return line_observers_[static_cast<std::size_t>(id.value)];
  }
  [[nodiscard]] std::span<const Observer> observers(PlaneId id) const {
    return plane_observers_[static_cast<std::size_t>(id.value)];
  }

  /// Living points and lines near the camera's viewing frustum, by id. The time it takes does not grow with the map.
  [[nodiscard]] std::vector<PointId> points_near(const geometry::CameraModel& camera,
                                                 const geometry::Pose& camera_from_world) const;
  [[nodiscard]] std::vector<LineId> lines_near(const geometry::CameraModel& camera,
                                               const geometry::Pose& camera_from_world) const;

  /// Counts that features were expected in a frame, and which of them were found. What is expected often and found
  /// rarely is culled, unless it is a line that a second keyframe confirmed.
  void count_visibility(std::span<const PointId> expected_points, std::span<const LineId> expected_lines,
                        const Matches& found);

  /// The keyframes that share features with keyframe `id`, most shared first.
  [[nodiscard]] std::vector<egraph::Covisibility> covisible(KeyframeId id) const;

  // For optimisers: new values for what is there.
  void move_keyframe(KeyframeId id, const geometry::Pose& world_from_camera);
  void move_keyframe_and_what_it_alone_saw(KeyframeId id, const geometry::Pose& world_from_camera);
  void move_point(PointId id, const Eigen::Vector3d& position);
  void move_line(LineId id, const Eigen::Vector3d& start, const Eigen::Vector3d& end);
  void move_plane(PlaneId id, const geometry::Plane& plane);
  void cull(PointId id);
  void cull(LineId id);

 private:
  void add_points(MapKeyframe& keyframe);
  void add_lines(MapKeyframe& keyframe);
  void add_planes(MapKeyframe& keyframe);

  std::vector<MapPoint> points_;
  std::vector<MapLine> lines_;
  std::vector<MapPlane> planes_;
  std::vector<MapKeyframe> keyframes_;
  SpatialIndex<PointId> point_index_;                   ///< the living
  SpatialIndex<LineId> line_index_;                     ///< the living, by middle point
  std::vector<std::vector<Observer>> point_observers_;  ///< one list per point, by id
  std::vector<std::vector<Observer>> line_observers_;
  std::vector<std::vector<Observer>> plane_observers_;
};

}  // namespace eg::tracking
