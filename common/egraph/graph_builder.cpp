#include "common/egraph/graph_builder.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <string>

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

base::Status BuilderState::apply(const GraphUpdate& update) {
  if (const auto applied = graph.apply(update); !applied) return applied;
  for (const DirectionLandmark& landmark : update.landmarks) {
    next_landmark = std::max(next_landmark, landmark.id.value + 1);
  }
  recent.push_back(update);
  if (recent.size() > kRecentUpdates) recent.pop_front();
  return {};
}

base::Status BuilderState::reset(const GraphSnapshot& snapshot) {
  if (const auto taken = graph.reset(snapshot); !taken) return taken;
  recent.clear();
  next_landmark = graph.landmarks().empty() ? 0 : graph.landmarks().back().id.value + 1;
  return {};
}

Arrival GraphBuilder::arrival_of(const Keyframe& keyframe) const {
  const auto keyframes = graph().keyframes();
  const std::int32_t next = keyframes.empty() ? 0 : keyframes.back().id.value + 1;
  if (keyframe.id.value == next) return Arrival::next;
  if (keyframe.id.value > next) return Arrival::early;
  const KeyframeNode* known = graph().find_keyframe(keyframe.id);
  const bool same =
      known != nullptr && known->sequence == keyframe.header.sequence && known->utime == keyframe.header.utime;
  return same ? Arrival::repeated : Arrival::foreign;
}

base::Result<GraphUpdate> GraphBuilder::add_keyframe(const Keyframe& keyframe) {
  const std::string name = "keyframe " + std::to_string(keyframe.id.value);
  switch (arrival_of(keyframe)) {
    case Arrival::next:
      break;
    case Arrival::repeated:
      for (const GraphUpdate& update : state_.recent) {
        if (update.keyframe.id == keyframe.id) return update;
      }
      return base::fail(name + " has long been in the graph");
    case Arrival::early:
      return base::fail(name + " came before keyframe " + std::to_string(graph().keyframes().size()));
    case Arrival::foreign:
      return base::fail(name + " is not the one that the graph of session " + std::to_string(keyframe.header.session) +
                        " holds under this number");
  }

  GraphUpdate update;
  update.session = keyframe.header.session;
  update.base_version = graph().version();
  update.version = graph().version() + 1;
  update.keyframe = {keyframe.id, keyframe.header.sequence, keyframe.header.utime, keyframe.world_from_camera,
                     keyframe.covariance};
  update.covisible = keyframe.covisible;
  fuse(keyframe, update);
  remove_stale_potentials(keyframe, update);
  connect(update);
  if (const auto applied = state_.apply(update); !applied) return tl::make_unexpected(applied.error());
  return update;
}

void GraphBuilder::fuse(const Keyframe& keyframe, GraphUpdate& update) const {
  const Eigen::Matrix3d& world_from_camera = keyframe.world_from_camera.rotation;
  const Eigen::Matrix3d rotation_covariance = keyframe.covariance.topLeftCorner<3, 3>();
  // Landmarks made by this keyframe take part at once: two parallel walls seen for the first time are one landmark.
  std::vector<DirectionLandmark> landmarks(graph().landmarks().begin(), graph().landmarks().end());
  std::int32_t next_landmark = state_.next_landmark;

  for (std::size_t i = 0; i < keyframe.directions.size(); ++i) {
    const features::DirectionFeature& feature = keyframe.directions[i];
    const auto matches =
        associate(std::span(&feature, 1), landmarks, world_from_camera, rotation_covariance, options_.association);
    const Eigen::Matrix3d covariance = direction_covariance_in_world(feature, world_from_camera, rotation_covariance);
    const double sign = matches.empty() ? 1.0 : matches.front().sign;
    auto landmark = landmarks.end();
    if (matches.empty()) {
      const LandmarkId id{next_landmark++};
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
  for (DirectionLandmark& landmark : landmarks) {
    if (landmark.last_seen != keyframe.id) continue;
    // As messages and journals carry it, to the last bit: a builder that starts from them goes on in the same way.
    landmark.covariance = Eigen::Matrix3d(landmark.covariance.selfadjointView<Eigen::Upper>());
    update.landmarks.push_back(landmark);
  }
}

void GraphBuilder::remove_stale_potentials(const Keyframe& keyframe, GraphUpdate& update) const {
  for (const DirectionLandmark& landmark : graph().landmarks()) {
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
  for (Edge& edge : update.edges = graph().sharing_keyframes(seen_before)) edge.second = update.keyframe.id;
}

}  // namespace eg::egraph
