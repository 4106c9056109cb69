#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/base/id.hpp"
#include "common/features/features.hpp"
#include "common/geometry/pose.hpp"

namespace eg::egraph {

using KeyframeId = base::Id<struct KeyframeTag>;
using LandmarkId = base::Id<struct LandmarkTag>;
using features::DirectionKind;

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A keyframe that shares map features (points, lines, planes) with another one.
struct Covisibility {
  KeyframeId keyframe;
  std::int32_t shared_features = 0;
};

/// Where one keyframe stands as seen from another, measured from the map features that both saw: a covisibility edge
/// with what it says about the poses.
struct RelativePose {
  KeyframeId first;
  KeyframeId second;
  geometry::Pose first_from_second;
  Matrix6d covariance = Matrix6d::Zero();  ///< of (rotation, translation), frame `first`, left perturbation; rad, m
};

/// The new pose of a keyframe that has been announced before.
struct CorrectedPose {
  KeyframeId keyframe;
  geometry::Pose world_from_camera;
};

/// A keyframe as the tracker announces it: a node of N_c with what it observed.
struct Keyframe {
  image::FrameHeader header;
  KeyframeId id;                           ///< counted from 0 within a session
  geometry::Pose world_from_camera;        ///< world: the first keyframe's camera
  Matrix6d covariance = Matrix6d::Zero();  ///< of (rotation, translation), world frame, left perturbation; rad, m
  std::vector<features::DirectionFeature> directions;
  std::vector<double>
      plane_distances;  ///< one per direction: the plane's distance in the camera frame, NaN if no plane
  std::vector<Covisibility> covisible;
  std::vector<RelativePose> relative_poses;  ///< new, or measured better than before
  std::vector<CorrectedPose> moved;  ///< older keyframes that the tracker has moved since it announced the last one
};

/// A node of N_lm: a scene direction fused from many views (paper, section 4.1), in the world frame.
struct DirectionLandmark {
  LandmarkId id;
  DirectionKind kind = DirectionKind::plane_normal;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, world frame
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< rad², tangential
  std::int32_t observations = 0;                         ///< keyframes that saw it
  KeyframeId first_seen;
  KeyframeId last_seen;
};

/// One keyframe's view of one landmark.
struct Observation {
  KeyframeId keyframe;
  LandmarkId landmark;
  Eigen::Vector3d direction_in_camera = Eigen::Vector3d::UnitZ();  ///< sign unified with the landmark (paper, eq. 8)
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();            ///< rad², tangential
};

/// An edge of E: two keyframes that share two or more non-parallel landmarks, whether their views overlap or not.
struct Edge {
  KeyframeId first;   ///< the older one
  KeyframeId second;  ///< the younger one
  std::vector<LandmarkId> shared;
};

/// A keyframe as the graph keeps it.
struct KeyframeNode {
  KeyframeId id;
  std::int64_t sequence = 0;
  std::int64_t utime = 0;
  geometry::Pose world_from_camera;
  Matrix6d covariance = Matrix6d::Zero();
};

/// What one keyframe changed in the graph. Applying it to a graph of version `base_version` gives `version`.
struct GraphUpdate {
  std::int64_t session = 0;
  std::int64_t base_version = 0;
  std::int64_t version = 0;
  KeyframeNode keyframe;
  std::vector<DirectionLandmark> landmarks;  ///< new or changed, whole
  std::vector<LandmarkId> removed;           ///< potential directions that found no partner
  std::vector<Observation> observations;     ///< of `keyframe`
  std::vector<Covisibility> covisible;       ///< of `keyframe`
  std::vector<RelativePose> relative_poses;  ///< new, or measured better than before
  std::vector<CorrectedPose> moved;          ///< by the tracker: as `keyframe` was announced
  std::vector<CorrectedPose> corrections;    ///< by the optimisation of the graph, after that
};

/// The whole graph at a version, or a part of it (common/egraph/snapshot_parts.hpp): for late joiners, for disk, for
/// receivers that missed an update. Edges are not in it: they follow from the observations.
struct GraphSnapshot {
  std::int64_t session = 0;
  std::int64_t version = 0;
  std::int32_t part = 0;
  std::int32_t parts = 1;
  LandmarkId next_landmark{0};  ///< what the next one will be called: ids are never reused
  std::vector<KeyframeNode> keyframes;
  std::vector<DirectionLandmark> landmarks;
  std::vector<Observation> observations;
  struct CovisibilityEdge {
    KeyframeId first, second;
    std::int32_t shared_features = 0;
  };
  std::vector<CovisibilityEdge> covisibility;
  std::vector<RelativePose> relative_poses;
};

/// A graph with its edges written out, for files and pictures.
struct GraphWithEdges : GraphSnapshot {
  std::vector<Edge> edges;
};

}  // namespace eg::egraph
