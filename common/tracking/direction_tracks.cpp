#include "common/tracking/direction_tracks.hpp"

#include <Eigen/LU>

#include "common/features/direction_evidence.hpp"
#include "common/geometry/so3.hpp"

namespace eg::tracking {
namespace {

using features::DirectionFeature;
using features::DirectionKind;

/// rad²: no average makes edges straighter than they are.
constexpr double kCommonVariance = features::kStraightness * features::kStraightness;
/// rad² (0.01°): exact data must not divide by zero.
constexpr double kLeastVariance = 3e-8;

/// In a tangent plane, rad²: what the uncertain rotation of the camera makes of a direction.
Eigen::Matrix2d turn_covariance(const DirectionViews& frame, const Eigen::Vector3d& in_world,
                                const Eigen::Matrix<double, 3, 2>& basis) {
  const Eigen::Matrix<double, 3, 2> lever = geometry::hat(in_world).transpose() * basis;
  return lever.transpose() * frame.rotation_covariance * lever;
}

}  // namespace

DirectionTracks::Track DirectionTracks::begin(const DirectionFeature& seen, const Eigen::Vector3d& in_world) {
  Track track;
  track.first = in_world;
  track.basis = geometry::tangent_basis(in_world);
  track.support = seen.support;
  return track;
}

DirectionTracks::Estimate DirectionTracks::measured(const Track& track, const DirectionFeature& seen, double sign,
                                                    const Eigen::Matrix3d& world_from_camera) {
  const Eigen::Matrix<double, 3, 2> in_camera = world_from_camera.transpose() * track.basis;
  const Eigen::Matrix2d noise = in_camera.transpose() * seen.covariance * in_camera;
  Estimate estimate;
  estimate.information = (noise + kLeastVariance * Eigen::Matrix2d::Identity()).inverse();
  estimate.weighted = estimate.information * (sign * (in_camera.transpose() * seen.direction));
  return estimate;
}

void DirectionTracks::add(const DirectionViews& frame) {
  for (const egraph::Association& association : frame.associations) {
    const DirectionFeature& seen = frame.directions[association.feature];
    if (seen.kind == DirectionKind::plane_normal) continue;
    const Eigen::Vector3d in_world = association.sign * (frame.world_from_camera * seen.direction);
    Track& track = tracks_.try_emplace(association.landmark, begin(seen, in_world)).first->second;
    const Estimate estimate = measured(track, seen, association.sign, frame.world_from_camera);
    track.sum.information += estimate.information;
    track.sum.weighted += estimate.weighted;
    track.turns += turn_covariance(frame, in_world, track.basis);
    ++track.frames;
  }
}

DirectionTracks::Estimate DirectionTracks::mean_in(const DirectionViews& keyframe, const Track& track) {
  // The frames were placed in one map: their turns err together, and do not average out.
  const Eigen::Matrix2d noise = track.sum.information.inverse();
  const Eigen::Matrix2d turns = track.turns / track.frames + turn_covariance(keyframe, track.first, track.basis);
  Estimate mean;
  mean.information = (noise + turns).inverse();
  mean.weighted = mean.information * (noise * track.sum.weighted);
  return mean;
}

void DirectionTracks::write(const Track& track, const Estimate& fused, double sign,
                            const Eigen::Matrix3d& world_from_camera, DirectionFeature& direction) {
  const Eigen::Matrix2d covariance = fused.information.inverse();
  const Eigen::Vector3d in_world = (track.first + track.basis * (covariance * fused.weighted)).normalized();
  direction.direction = sign * (world_from_camera.transpose() * in_world);
  const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(direction.direction);
  const Eigen::Matrix2d turned = basis.transpose() * world_from_camera.transpose() * track.basis;
  direction.covariance = basis *
                         (turned * covariance * turned.transpose() + kCommonVariance * Eigen::Matrix2d::Identity()) *
                         basis.transpose();
}

AssociatedDirections DirectionTracks::fuse(const DirectionViews& keyframe) const {
  AssociatedDirections result{{keyframe.directions.begin(), keyframe.directions.end()},
                              {keyframe.associations.begin(), keyframe.associations.end()}};
  std::map<egraph::LandmarkId, Track> unseen = tracks_;
  for (const egraph::Association& association : keyframe.associations) {
    const auto found = unseen.find(association.landmark);
    if (found == unseen.end())
      continue;  // no track, or it has been told: single lines may share a landmark with a group
    const Track track = found->second;
    unseen.erase(found);
    DirectionFeature& direction = result.directions[association.feature];
    Estimate fused = mean_in(keyframe, track);
    const Estimate own = measured(track, direction, association.sign, keyframe.world_from_camera);
    fused.information += own.information;
    fused.weighted += own.weighted;
    write(track, fused, association.sign, keyframe.world_from_camera, direction);
  }
  for (const auto& [landmark, track] : unseen) {
    if (result.directions.size() == features::kMaxDirections) break;
    result.associations.push_back({.feature = result.directions.size(), .landmark = landmark});
    DirectionFeature& direction = result.directions.emplace_back(
        DirectionFeature{.kind = DirectionKind::vanishing_direction, .support = track.support});
    write(track, mean_in(keyframe, track), 1.0, keyframe.world_from_camera, direction);
  }
  return result;
}

void DirectionTracks::turn(const Eigen::Matrix3d& rotation) {
  for (auto& [landmark, track] : tracks_) {
    track.first = rotation * track.first;
    track.basis = rotation * track.basis;
  }
}

}  // namespace eg::tracking
