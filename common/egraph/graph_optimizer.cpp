#include "common/egraph/graph_optimizer.hpp"

#include <algorithm>
#include <bit>

#include "common/egraph/graph_problem.hpp"
#include "common/geometry/so3.hpp"

namespace eg::egraph {
namespace {

constexpr double kInitialDamping = 1e-6;
constexpr double kMaxDamping = 1e6;
constexpr double kConvergence = 1e-6;  ///< relative decrease of the cost below which nothing more is to be gained

GraphCorrections corrections_of(const Graph& graph, const GraphProblem& problem, const GraphOptimizerOptions& options) {
  GraphCorrections corrections;
  for (const GraphProblem::Keyframe& keyframe : problem.keyframes) {
    const geometry::Pose& before = graph.find_keyframe(keyframe.id)->world_from_camera;
    const geometry::Pose& after = keyframe.world_from_camera;
    if (geometry::rotation_angle_between(before.rotation, after.rotation) > options.min_rotation_step ||
        (before.translation - after.translation).norm() > options.min_translation_step) {
      corrections.keyframes.push_back({keyframe.id, {geometry::nearest_rotation(after.rotation), after.translation}});
    }
  }
  for (const GraphProblem::Landmark& landmark : problem.landmarks) {
    DirectionLandmark moved = *graph.find_landmark(landmark.id);
    if (geometry::axial_angle(moved.direction, landmark.direction) <= options.min_rotation_step) continue;
    const Eigen::Matrix3d turn = geometry::rotation_between(moved.direction, landmark.direction);
    moved.direction = landmark.direction;
    moved.covariance = turn * moved.covariance * turn.transpose();
    moved.covariance = 0.5 * (moved.covariance + moved.covariance.transpose()).eval();
    corrections.landmarks.push_back(moved);
  }
  return corrections;
}

}  // namespace

GraphCorrections optimize_graph(const Graph& graph, const GraphOptimizerOptions& options) {
  if (options.refine == Refinement::none || graph.keyframes().size() < 2) return {};
  GraphProblem problem = make_problem(graph, options);
  const double initial_cost = problem.cost();
  double cost = initial_cost;
  double damping = kInitialDamping;
  int iteration = 0;
  for (bool converged = false; iteration < options.max_iterations && !converged; ++iteration) {
    const GraphProblem::Linearization linear = problem.linearize();
    bool improved = false;
    while (!improved && damping < kMaxDamping) {
      const auto keyframes = problem.keyframes;
      const auto landmarks = problem.landmarks;
      const double moved_cost = problem.step(linear, damping) ? problem.cost() : cost;
      improved = moved_cost < cost;
      damping *= improved ? 0.1 : 10.0;
      if (improved) {
        converged = cost - moved_cost < kConvergence * cost;
        cost = moved_cost;
      } else {
        problem.keyframes = keyframes;
        problem.landmarks = landmarks;
      }
    }
    damping = std::max(damping, kInitialDamping);
    if (!improved) break;
  }
  GraphCorrections corrections = corrections_of(graph, problem, options);
  corrections.initial_cost = initial_cost;
  corrections.final_cost = cost;
  corrections.iterations = iteration;
  return corrections;
}

bool optimization_is_due(std::size_t keyframes) {
  constexpr std::size_t kShortest = 8;
  constexpr std::size_t kLongest = 128;
  return keyframes >= kShortest && keyframes % std::clamp(std::bit_floor(keyframes / 10), kShortest, kLongest) == 0;
}

}  // namespace eg::egraph
