#include "common/tracking/graph_rotation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <span>
#include <utility>

namespace eg::tracking {
namespace {

using egraph::Association;
using egraph::DirectionKind;
using egraph::DirectionLandmark;

/// A rotation and its covariance as association wants it: of world_from_camera.
struct Belief {
  Eigen::Matrix3d camera_from_world;
  Eigen::Matrix3d covariance;
};

class Solver {
 public:
  Solver(std::span<const features::DirectionFeature> directions, const egraph::Graph& graph,
         const GraphRotationOptions& options)
      : directions_(directions), graph_(graph), options_(options) {}

  [[nodiscard]] std::vector<Association> associate(const Belief& belief) const {
    return egraph::associate(directions_, graph_, belief.camera_from_world.transpose(), belief.covariance,
                             options_.association);
  }

  [[nodiscard]] std::vector<Association> candidates(const Belief& belief) const {
    return egraph::candidates(directions_, graph_, belief.camera_from_world.transpose(), belief.covariance,
                              options_.association);
  }

  [[nodiscard]] bool is_single_line(const Association& association) const {
    return directions_[association.feature].kind == DirectionKind::potential_direction;
  }

  [[nodiscard]] GraphRotation solve(Belief belief, bool with_single_lines) const {
    GraphRotation result;
    const egraph::RotationPrior prior{belief.camera_from_world, std::sqrt(belief.covariance(0, 0))};
    // The second round associates with the rotation of the first: what lies close together is told apart.
    for (int round = 0; round < 2; ++round) {
      result.associations = round == 0 ? candidates(belief) : associate(belief);
      if (!with_single_lines) std::erase_if(result.associations, [&](const auto& a) { return is_single_line(a); });
      const egraph::RotationEstimate estimate =
          egraph::estimate_rotation(pairs(result.associations), options_.consensus, prior);
      result.determined = estimate.status == egraph::RotationStatus::ok;
      if (!result.determined) return result;
      keep(estimate.inliers, result.associations);
      const Eigen::Matrix3d world_from_camera = estimate.j_from_k.transpose();
      belief = {estimate.j_from_k, world_from_camera * estimate.covariance * estimate.j_from_k};
    }
    result.camera_from_world = belief.camera_from_world;
    if (!with_single_lines) add_single_lines(belief, result.associations);
    return result;
  }

 private:
  [[nodiscard]] std::vector<egraph::DirectionPair> pairs(std::span<const Association> associations) const {
    std::vector<egraph::DirectionPair> pairs;
    for (const Association& association : associations) {
      const features::DirectionFeature& seen = directions_[association.feature];
      const DirectionLandmark& landmark = *graph_.find_landmark(association.landmark);
      pairs.push_back({association.sign * seen.direction, landmark.direction, seen.covariance, landmark.covariance,
                       association.outlier_chi2, static_cast<std::int32_t>(association.feature)});
    }
    return pairs;
  }

  static void keep(const std::vector<bool>& inliers, std::vector<Association>& associations) {
    std::vector<Association> kept;
    for (std::size_t i = 0; i < associations.size(); ++i) {
      if (inliers[i]) kept.push_back(associations[i]);
    }
    associations = std::move(kept);
  }

  void add_single_lines(const Belief& belief, std::vector<Association>& associations) const {
    const std::vector<Association> all = associate(belief);
    std::copy_if(all.begin(), all.end(), std::back_inserter(associations),
                 [&](const auto& association) { return is_single_line(association); });
  }

  std::span<const features::DirectionFeature> directions_;
  const egraph::Graph& graph_;
  const GraphRotationOptions& options_;
};

}  // namespace

GraphRotation estimate_rotation_from_graph(const features::FrameFeatures& features, const egraph::Graph& graph,
                                           const Eigen::Matrix3d& predicted_camera_from_world, double rotation_sigma,
                                           const GraphRotationOptions& options) {
  const Solver solver(features.directions, graph, options);
  const Belief prediction{predicted_camera_from_world, rotation_sigma * rotation_sigma * Eigen::Matrix3d::Identity()};
  // Single lines are many and vague: voting with the others they would overrule the walls.
  GraphRotation result = solver.solve(prediction, false);
  if (!result.determined) result = solver.solve(prediction, true);
  if (!result.determined) return result;
  std::vector<egraph::LandmarkId> seen;
  for (const Association& association : result.associations) seen.push_back(association.landmark);
  result.reference = graph.oldest_sharing_keyframe(seen).value_or(egraph::KeyframeId{});
  return result;
}

}  // namespace eg::tracking
