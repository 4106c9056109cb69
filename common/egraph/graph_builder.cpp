#include "common/egraph/graph_builder.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <map>
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

/// What the graph calls a direction that was seen once more, in this keyframe or another: a potential direction that
/// found a partner, be it vanishing or potential, is a vanishing direction from then on (paper, section 4.2).
DirectionKind fused_kind(DirectionKind landmark) {
  return landmark == DirectionKind::potential_direction ? DirectionKind::vanishing_direction : landmark;
}

/// The landmarks as one keyframe changes them. Those that it makes take part at once: two parallel walls seen for the
/// first time are one landmark.
class ChangedLandmarks {
 public:
  explicit ChangedLandmarks(const Graph& graph) : graph_(graph), next_(graph.next_landmark()) {}

  [[nodiscard]] std::vector<DirectionLandmark> near(const Eigen::Vector3d& direction, double max_angle) const {
    std::vector<DirectionLandmark> found;
    for (const DirectionLandmark* landmark : graph_.landmarks_near(direction, max_angle + kMaxFusionStep)) {
      const auto changed = changed_.find(landmark->id);
      found.push_back(changed != changed_.end() ? changed->second : *landmark);
    }
    for (auto made = changed_.lower_bound(graph_.next_landmark()); made != changed_.end(); ++made) {
      found.push_back(made->second);
    }
    return found;
  }

  DirectionLandmark& change(LandmarkId id) {
    if (const auto changed = changed_.find(id); changed != changed_.end()) return changed->second;
    return changed_.emplace(id, *graph_.find_landmark(id)).first->second;
  }

  DirectionLandmark& make(DirectionKind kind, const Eigen::Vector3d& direction, const Eigen::Matrix3d& covariance,
                          KeyframeId seen) {
    const LandmarkId id = next_;
    ++next_.value;
    return changed_.emplace(id, DirectionLandmark{id, kind, direction, covariance, 1, seen, seen}).first->second;
  }

  [[nodiscard]] std::vector<DirectionLandmark> take() const {
    std::vector<DirectionLandmark> landmarks;
    for (const auto& [id, landmark] : changed_) {
      landmarks.push_back(landmark);
      // As messages and journals carry it, to the last bit: a builder that starts from them goes on in the same way.
      landmarks.back().covariance = Eigen::Matrix3d(landmark.covariance.selfadjointView<Eigen::Upper>());
    }
    return landmarks;
  }

 private:
  /// How far (radians) one keyframe may turn a landmark before it is looked for again; the gate is 5°.
  static constexpr double kMaxFusionStep = 0.09;

  const Graph& graph_;
  LandmarkId next_;
  std::map<LandmarkId, DirectionLandmark> changed_;
};

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
  remember(update);
  return {};
}

base::Status BuilderState::reset(const GraphSnapshot& snapshot) {
  if (const auto taken = graph.reset(snapshot); !taken) return taken;
  recent.clear();
  return {};
}

void BuilderState::remember(const GraphUpdate& update) {
  recent.push_back(update);
  if (recent.size() > kRecentUpdates) recent.pop_front();
}

Arrival GraphBuilder::arrival_of(const Keyframe& keyframe) const {
  const std::int32_t next = graph().keyframes().empty() ? 0 : graph().keyframes().back().id.value + 1;
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
  update.relative_poses = keyframe.relative_poses;
  update.moved = keyframe.moved;
  fuse(keyframe, update);
  remove_stale_potentials(keyframe, update);
  if (const auto applied = state_.graph.apply(update); !applied) return tl::make_unexpected(applied.error());
  if (optimization_is_due(graph().keyframes().size())) optimize(update);
  state_.remember(update);
  return update;
}

void GraphBuilder::fuse(const Keyframe& keyframe, GraphUpdate& update) const {
  const Eigen::Matrix3d& world_from_camera = keyframe.world_from_camera.rotation;
  const Eigen::Matrix3d rotation_covariance = keyframe.covariance.topLeftCorner<3, 3>();
  ChangedLandmarks landmarks(graph());
  for (const features::DirectionFeature& feature : keyframe.directions) {
    const Eigen::Vector3d in_world = world_from_camera * feature.direction;
    const Eigen::Matrix3d covariance = direction_covariance_in_world(feature, world_from_camera, rotation_covariance);
    const auto match = associate(feature, landmarks.near(in_world, options_.association.max_angle), world_from_camera,
                                 rotation_covariance, options_.association);
    const double sign = match ? match->sign : 1.0;
    DirectionLandmark& landmark =
        match ? landmarks.change(match->landmark) : landmarks.make(feature.kind, in_world, covariance, keyframe.id);
    if (match) {
      fuse_direction(landmark, sign * in_world, covariance, options_.min_landmark_sigma);
      landmark.kind = fused_kind(landmark.kind);
      if (landmark.last_seen != keyframe.id) ++landmark.observations;
      landmark.last_seen = keyframe.id;
    }
    update.observations.push_back({keyframe.id, landmark.id, sign * feature.direction, feature.covariance});
  }
  update.landmarks = landmarks.take();
}

void GraphBuilder::remove_stale_potentials(const Keyframe& keyframe, GraphUpdate& update) const {
  for (const LandmarkId id : graph().potential_directions()) {
    const bool promoted = std::any_of(update.landmarks.begin(), update.landmarks.end(),
                                      [id](const DirectionLandmark& changed) { return changed.id == id; });
    const std::int32_t unseen = keyframe.id.value - graph().find_landmark(id)->last_seen.value;
    if (!promoted && unseen >= options_.potential_lifetime) update.removed.push_back(id);
  }
}

void GraphBuilder::optimize(GraphUpdate& update) {
  GraphCorrections corrections = optimize_graph(graph(), options_.optimizer);
  state_.graph.refine(corrections.keyframes, corrections.landmarks);
  update.corrections = std::move(corrections.keyframes);
  for (DirectionLandmark& moved : corrections.landmarks) {
    const auto changed = std::find_if(update.landmarks.begin(), update.landmarks.end(),
                                      [&](const DirectionLandmark& landmark) { return landmark.id == moved.id; });
    if (changed != update.landmarks.end()) {
      *changed = std::move(moved);
    } else {
      update.landmarks.push_back(std::move(moved));
    }
  }
}

}  // namespace eg::egraph
