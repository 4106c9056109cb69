#include <algorithm>
#include <cstddef>
#include <map>

#include "common/egraph/graph_problem.hpp"

namespace eg::egraph {
namespace {

class ProblemMaker {
 public:
  ProblemMaker(const Graph& graph, const GraphOptimizerOptions& options)
      : graph_(graph), options_(options), problem_(options), first_(first_refined(graph, options)) {}

  GraphProblem make() {
    const auto keyframes = graph_.keyframes();
    for (std::size_t i = first_; i < keyframes.size(); ++i) {
      add_keyframe(keyframes[i], i > 0 ? problem_.keyframe_unknowns() : 0);
    }
    for (std::size_t i = first_; i < keyframes.size(); ++i) add_views(keyframes[i].id);
    for (std::size_t i = 0; i < problem_.landmarks.size(); ++i) add_older_views(i);
    add_constraints();
    return std::move(problem_);
  }

 private:
  static std::size_t first_refined(const Graph& graph, const GraphOptimizerOptions& options) {
    const std::size_t keyframes = graph.keyframes().size();
    return keyframes - std::min(keyframes, static_cast<std::size_t>(options.max_keyframes));
  }

  /// The column of so many new unknowns; -1 for none.
  int take_columns(int unknowns) {
    if (unknowns == 0) return -1;
    const int column = problem_.unknowns;
    problem_.unknowns += unknowns;
    return column;
  }

  std::size_t add_keyframe(const KeyframeNode& node, int unknowns) {
    const std::size_t index = problem_.keyframes.size();
    problem_.keyframes.push_back({node.id, node.world_from_camera, take_columns(unknowns)});
    index_of_keyframe_[node.id] = index;
    return index;
  }

  void add_views(KeyframeId id) {
    for (const Observation& observation : graph_.observations(id)) {
      if (graph_.observers(observation.landmark).size() < 2) continue;  // nothing to agree with
      const auto [landmark, is_new] = index_of_landmark_.try_emplace(observation.landmark, problem_.landmarks.size());
      if (is_new) add_landmark(observation.landmark);
      add_view(index_of_keyframe_.at(id), landmark->second, observation);
    }
  }

  /// The last that keyframes which are held saw of a landmark before those which are refined: at most as many views as
  /// there are refined keyframes. They say where the landmark is; its own direction follows whoever saw it last.
  void add_older_views(std::size_t landmark) {
    const LandmarkId id = problem_.landmarks[landmark].id;
    const std::span<const KeyframeId> observers = graph_.observers(id);
    const auto end = std::lower_bound(observers.begin(), observers.end(), graph_.keyframes()[first_].id);
    const auto older = std::min<std::ptrdiff_t>(end - observers.begin(), options_.max_keyframes);
    for (auto observer = end - older; observer != end; ++observer) {
      const std::size_t keyframe = index_or_held(*observer);
      for (const Observation& observation : graph_.observations(*observer)) {
        if (observation.landmark == id) add_view(keyframe, landmark, observation);
      }
    }
  }

  void add_view(std::size_t keyframe, std::size_t landmark, const Observation& observation) {
    problem_.views.push_back({keyframe, landmark, observation.direction_in_camera, observation.covariance});
  }

  void add_landmark(LandmarkId id) {
    problem_.landmarks.push_back({id, graph_.find_landmark(id)->direction, take_columns(2)});
  }

  void add_constraints() {
    const KeyframeId oldest = graph_.keyframes()[first_].id;
    for (const RelativePose& measured : graph_.relative_poses_from(oldest)) {
      problem_.constraints.push_back({index_or_held(measured.first), index_or_held(measured.second), measured});
    }
  }

  std::size_t index_or_held(KeyframeId id) {
    const auto known = index_of_keyframe_.find(id);
    return known != index_of_keyframe_.end() ? known->second : add_keyframe(*graph_.find_keyframe(id), 0);
  }

  const Graph& graph_;
  const GraphOptimizerOptions& options_;
  GraphProblem problem_;
  std::size_t first_;  ///< index of the oldest keyframe that is refined
  std::map<KeyframeId, std::size_t> index_of_keyframe_;
  std::map<LandmarkId, std::size_t> index_of_landmark_;
};

}  // namespace

GraphProblem make_problem(const Graph& graph, const GraphOptimizerOptions& options) {
  return ProblemMaker(graph, options).make();
}

}  // namespace eg::egraph
