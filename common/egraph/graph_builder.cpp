#include "common/egraph/graph_builder.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "common/geometry/so3.hpp"

namespace eg::egraph {
namespace {

Eigen::Matrix3d lift(const Eigen::Matrix<double, 3, 2>& basis, const Eigen::Matrix2d& covariance) {
  return basis * covariance * basis.transpose();
}

Eigen::Matrix2d with_floor(const Eigen::Matrix2d& covariance, double min_sigma) {
  return covariance + min_sigma * min_sigma * Eigen::Matrix2d::Identity();
}

/// What the graph calls a direction that was seen in one more keyframe: a potential direction that found a partner, be
/// it vanishing or potential, is a vanishing direction from then on (paper, section 4.2).
DirectionKind fused_kind(DirectionKind landmark) {
  return landmark == DirectionKind::potential_direction ? DirectionKind::vanishing_direction : landmark;
}

}  // namespace

void fuse_direction(DirectionLandmark& landmark, const Eigen::Vector3d& direction, const Eigen::Matrix3d& covariance,
                    double min_sigma) {
  const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(landmark.direction);
  const Eigen::Matrix2d prior = with_floor(basis.transpose() * landmark.covariance * basis, min_sigma);
  const Eigen::Matrix2d measured = with_floor(basis.transpose() * covariance * basis, min_sigma);
  const Eigen::Matrix2d gain = prior * (prior + measured).inverse();
  const Eigen::Vector2d step = gain * (basis.transpose() * direction);
  const Eigen::Matrix2d posterior = (Eigen::Matrix2d::Identity() - gain) * prior;
  landmark.direction = (landmark.direction + basis * step).normalized();
  const Eigen::Matrix<double, 3, 2> moved = geometry::tangent_basis(landmark.direction);
  const Eigen::Matrix2d turn = moved.transpose() * basis;
  landmark.covariance = lift(moved, turn * (0.5 * (posterior + posterior.transpose())) * turn.transpose());
}

base::Result<GraphUpdate> GraphBuilder::add_keyframe(const Keyframe& keyframe) {
  const auto next = static_cast<std::int32_t>(history_.size());
  if (keyframe.id.value < next) return history_[static_cast<std::size_t>(keyframe.id.value)];
  if (keyframe.id.value > next) {
    return base::fail("keyframe " + std::to_string(keyframe.id.value) + " came before keyframe " +
                      std::to_string(next));
  }

  GraphUpdate update;
  update.session = keyframe.header.session;
  update.base_version = graph_.version();
  update.version = graph_.version() + 1;
  update.keyframe = {keyframe.id, keyframe.header.sequence, keyframe.header.utime, keyframe.world_from_camera,
                     keyframe.covariance};
  update.covisible = keyframe.covisible;
  fuse(keyframe, update);
  remove_stale_potentials(keyframe, update);
  connect(update);
  if (const auto applied = graph_.apply(update); !applied) return tl::make_unexpected(applied.error());
  history_.push_back(update);
  return update;
}

void GraphBuilder::fuse(const Keyframe& keyframe, GraphUpdate& update) {
  const Eigen::Matrix3d& world_from_camera = keyframe.world_from_camera.rotation;
  const Eigen::Matrix3d rotation_covariance = keyframe.covariance.topLeftCorner<3, 3>();
  // Landmarks made by this keyframe take part at once: two parallel walls seen for the first time are one landmark.
  std::vector<DirectionLandmark> landmarks(graph_.landmarks().begin(), graph_.landmarks().end());

  for (std::size_t i = 0; i < keyframe.directions.size(); ++i) {
    const features::DirectionFeature& feature = keyframe.directions[i];
    const auto matches =
        associate(std::span(&feature, 1), landmarks, world_from_camera, rotation_covariance, options_.association);
    const Eigen::Matrix3d covariance = direction_covariance_in_world(feature, world_from_camera, rotation_covariance);
    const double sign = matches.empty() ? 1.0 : matches.front().sign;
    auto landmark = landmarks.end();
    if (matches.empty()) {
      const LandmarkId id{next_landmark_++};
      landmarks.push_back(
          {id, feature.kind, world_from_camera * feature.direction, covariance, 1, keyframe.id, keyframe.id});
      landmark = landmarks.end() - 1;
    } else {
      landmark = std::find_if(landmarks.begin(), landmarks.end(),
                              [&](const DirectionLandmark& l) { return l.id == matches.front().landmark; });
      fuse_direction(*landmark, sign * (world_from_camera * feature.direction), covariance,
                     options_.min_landmark_sigma);
      landmark->kind = fused_kind(landmark->kind);
      if (landmark->last_seen != keyframe.id) ++landmark->observations;
      landmark->last_seen = keyframe.id;
    }
    update.observations.push_back({keyframe.id, landmark->id, sign * feature.direction, feature.covariance});
  }
  for (const DirectionLandmark& landmark : landmarks) {
    if (landmark.last_seen == keyframe.id) update.landmarks.push_back(landmark);
  }
}

void GraphBuilder::remove_stale_potentials(const Keyframe& keyframe, GraphUpdate& update) const {
  for (const DirectionLandmark& landmark : graph_.landmarks()) {
    const bool promoted = std::any_of(update.landmarks.begin(), update.landmarks.end(),
                                      [&](const DirectionLandmark& changed) { return changed.id == landmark.id; });
    if (landmark.kind == DirectionKind::potential_direction && !promoted &&
        keyframe.id.value - landmark.last_seen.value >= options_.potential_lifetime) {
      update.removed.push_back(landmark.id);
    }
  }
}

void GraphBuilder::connect(GraphUpdate& update) const {
  std::vector<LandmarkId> seen_before;
  for (const DirectionLandmark& landmark : update.landmarks) {
    if (landmark.first_seen != update.keyframe.id) seen_before.push_back(landmark.id);
  }
  for (Edge& edge : update.edges = graph_.sharing_keyframes(seen_before)) edge.second = update.keyframe.id;
}

}  // namespace eg::egraph
