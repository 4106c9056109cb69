#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/egraph/types.hpp"
#include "common/features/features.hpp"
#include "services/viewer/board.hpp"
#include "services/viewer/graph_view.hpp"

namespace eg::services {

/// A plane of the map: what many keyframes saw of it.
struct MapPlane {
  geometry::Plane plane;              ///< world frame, normal towards the cameras
  std::vector<Eigen::Vector3d> hull;  ///< convex, on the plane, world frame, metres
  double support = 0.0;               ///< pixels of all observations together
};

/// Two planes that lie in each other and touch are one: its parameters are their mean by support, its hull that of
/// both. Otherwise nothing changes. Returns whether they were joined.
bool join(MapPlane& plane, const MapPlane& other);

/// The planes of all keyframes, joined where they are the same. Only for the eye: nothing is estimated from it.
class PlaneMap {
 public:
  void add(egraph::KeyframeId keyframe, const std::vector<features::PlaneFeature>& planes);
  void clear() { *this = {}; }

  /// The packet "planes". When poses have been corrected, all planes are joined afresh.
  bool put(Board& board, const GraphView& graph);

  [[nodiscard]] const std::vector<MapPlane>& planes() const { return planes_; }

 private:
  struct Observation {
    egraph::KeyframeId keyframe;
    features::PlaneFeature plane;
  };

  void join_new_observations(const GraphView& graph);

  std::vector<Observation> observations_;
  std::size_t joined_ = 0;  ///< how many of the observations are in planes_
  int corrections_ = 0;     ///< of the graph when they were
  std::vector<MapPlane> planes_;
};

}  // namespace eg::services
