#pragma once

#include <Eigen/Core>
#include <map>
#include <span>
#include <vector>

#include "common/egraph/association.hpp"
#include "common/features/features.hpp"

namespace eg::tracking {

/// The directions of one frame, and its rotation as points, lines and planes of the map have it. Had the directions a
/// say in that rotation, each would be found where its landmark is.
struct DirectionViews {
  std::span<const features::DirectionFeature> directions;
  std::span<const egraph::Association> associations;
  Eigen::Matrix3d world_from_camera;
  Eigen::Matrix3d rotation_covariance;  ///< rad², of world_from_camera, left perturbation
};

/// Directions of a keyframe and the landmarks of which they are views.
struct AssociatedDirections {
  std::vector<features::DirectionFeature> directions;
  std::vector<egraph::Association> associations;
};

/// Vanishing directions as the frames since the last keyframe measured them. The paper (section 4.2) lets the graph see
/// those of keyframes alone; the noise of a few short lines averages out over the frames between. What the frames have
/// in common does not: how straight edges are, and the turn to the keyframe. Both stay in the covariance. Normals of
/// planes are left out: their errors (warped depth, whole steps of disparity) stay from frame to frame.
class DirectionTracks {
 public:
  /// To be called with every frame between keyframes.
  void add(const DirectionViews& frame);

  /// The keyframe's directions, fused with their tracks, and those of tracks that the keyframe itself does not see.
  [[nodiscard]] AssociatedDirections fuse(const DirectionViews& keyframe) const;

  /// The map has turned (left perturbation), and the frames with it.
  void turn(const Eigen::Matrix3d& rotation);

  void clear() { tracks_.clear(); }

 private:
  /// A direction as information about its coordinates in a tangent plane.
  struct Estimate {
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  ///< rad⁻²
    Eigen::Vector2d weighted = Eigen::Vector2d::Zero();     ///< information times coordinates
  };
  /// What the frames measured of one landmark.
  struct Track {
    Eigen::Vector3d first;                            ///< the first measurement, world frame, unit
    Eigen::Matrix<double, 3, 2> basis;                ///< of its tangent plane
    std::int32_t support = 0;                         ///< its lines
    Estimate sum;                                     ///< of all measurements, were the rotations of the frames exact
    Eigen::Matrix2d turns = Eigen::Matrix2d::Zero();  ///< rad², sum of what those rotations add
    int frames = 0;
  };
  static Track begin(const features::DirectionFeature& seen, const Eigen::Vector3d& in_world);
  static Estimate measured(const Track& track, const features::DirectionFeature& seen, double sign,
                           const Eigen::Matrix3d& world_from_camera);
  static Estimate mean_in(const DirectionViews& keyframe, const Track& track);
  static void write(const Track& track, const Estimate& fused, double sign, const Eigen::Matrix3d& world_from_camera,
                    features::DirectionFeature& direction);

  std::map<egraph::LandmarkId, Track> tracks_;
};

}  // namespace eg::tracking
