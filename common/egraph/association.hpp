#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "common/egraph/graph.hpp"
#include "common/egraph/types.hpp"

namespace eg::egraph {

/// th_vd of the paper (section 4.2) as an angle, and the gate on the covariance-weighted difference.
struct AssociationOptions {
  double max_angle = 0.087;  ///< radians (5°)
  double max_chi2 = 13.82;   ///< 99.9 % quantile of chi²(2)
};

/// A direction of a frame and the landmark it is a view of.
struct Association {
  std::size_t feature = 0;  ///< index into the frame's directions
  LandmarkId landmark;
  double sign = 1.0;  ///< multiplies the feature's direction (paper, equation 8)
  double chi2 = 0.0;  ///< of the difference between direction and landmark
  /// Where the match becomes as likely by chance as by truth: see DirectionPair. A vague direction, or one that has
  /// many landmarks within the gate, fits somewhere anyhow.
  double outlier_chi2 = 0.0;
};

/// Rotates each direction into the world and lists the graph's landmarks within the gates, the directions one after the
/// other. Plane normals go with planes, vanishing and potential directions with each other; potential directions of the
/// graph are left out, which were seen once and may be any edge. `rotation_covariance`: rad², of world_from_camera,
/// left perturbation. The time it takes depends on the landmarks around the directions, not on the size of the graph.
std::vector<Association> candidates(std::span<const features::DirectionFeature> directions, const Graph& graph,
                                    const Eigen::Matrix3d& world_from_camera,
                                    const Eigen::Matrix3d& rotation_covariance, const AssociationOptions& options = {});

/// Of each direction's candidates the one that fits best. Several directions may view one landmark: parallel walls have
/// one normal.
std::vector<Association> associate(std::span<const features::DirectionFeature> directions, const Graph& graph,
                                   const Eigen::Matrix3d& world_from_camera, const Eigen::Matrix3d& rotation_covariance,
                                   const AssociationOptions& options = {});

/// The same for one direction among the landmarks given, whatever their kind; its index is 0.
std::optional<Association> associate(const features::DirectionFeature& direction,
                                     std::span<const DirectionLandmark> landmarks,
                                     const Eigen::Matrix3d& world_from_camera,
                                     const Eigen::Matrix3d& rotation_covariance,
                                     const AssociationOptions& options = {});

/// The covariance (rad², tangential, world frame) of a direction seen by a camera of uncertain rotation.
Eigen::Matrix3d direction_covariance_in_world(const features::DirectionFeature& feature,
                                              const Eigen::Matrix3d& world_from_camera,
                                              const Eigen::Matrix3d& rotation_covariance);

}  // namespace eg::egraph
