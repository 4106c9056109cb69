#include "common/tracking/bundle_adjustment.hpp"

#include <ceres/loss_function.h>
#include <ceres/ordered_groups.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>

#include "common/geometry/so3.hpp"
#include "common/tracking/bundle_costs.hpp"
#include "common/tracking/bundle_observations.hpp"
#include "common/tracking/frame_problem.hpp"
#include "common/tracking/robust_loss.hpp"

namespace eg::tracking {
namespace {

using geometry::Plane;
using geometry::Pose;

struct PointView {
  using Landmark = PointLandmark;
  static constexpr int kResiduals = 3;

  [[nodiscard]] BundleResidual<3, 3> residual(const Pose& camera_from_world, const double* point) const {
    PointFactor at = factor;
    at.point_in_world = Eigen::Map<const Eigen::Vector3d>(point);
    return bundle_point_residual(at, *camera, camera_from_world);
  }
  PointFactor factor;
  const geometry::CameraModel* camera;
};

struct LineView {
  using Landmark = LineLandmark;
  static constexpr int kResiduals = 4;

  [[nodiscard]] BundleResidual<4, 4> residual(const Pose& camera_from_world, const double* offsets) const {
    return bundle_line_residual(seen, *chart, Eigen::Map<const Eigen::Vector4d>(offsets), *camera, camera_from_world);
  }
  LineObservation seen;
  const LineChart* chart;
  const geometry::CameraModel* camera;
};

struct PlaneView {
  using Landmark = PlaneLandmark;
  static constexpr int kResiduals = 3;

  [[nodiscard]] BundleResidual<3, 3> residual(const Pose& camera_from_world, const double* plane) const {
    return bundle_plane_residual(seen, PlaneLandmark::read(plane), camera_from_world);
  }
  PlaneObservation seen;
};

/// The least-squares problem of a window. All its parameters lie in one array, poses first: Ceres orders parameters by
/// their addresses, and sums must not depend on where the allocator put things.
class BundleProblem {
 public:
  BundleProblem(const Map& map, const egraph::Graph& graph, const LocalWindow& window, const BundleOptions& options)
      : map_(map), window_(window), problem_(keep_ownership()) {
    allocate();
    for (std::size_t i = 0; i < window.keyframes.size(); ++i) add_keyframe(i, graph, options);
    add_points();
    add_lines();
    add_planes();
  }

  BundleSolution solve(const BundleOptions& options) {
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_SCHUR;
    solver.linear_solver_ordering = ordering_;
    solver.max_num_iterations = options.iterations;
    solver.function_tolerance = 1e-5;
    solver.num_threads = 1;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem_, &summary);
    BundleSolution solution;
    solution.initial_cost = summary.initial_cost;
    solution.final_cost = summary.final_cost;
    if (summary.IsSolutionUsable()) read_solution(solution);
    return solution;
  }

 private:
  /// Loss functions and manifolds are members and are shared by all residuals.
  static ceres::Problem::Options keep_ownership() {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  void allocate() {
    pose_offset_ = 0;
    point_offset_ = pose_offset_ + kPoseSize * window_.keyframes.size();
    line_offset_ = point_offset_ + PointLandmark::kSize * window_.points.size();
    plane_offset_ = line_offset_ + LineLandmark::kSize * window_.lines.size();
    parameters_.assign(plane_offset_ + PlaneLandmark::kSize * window_.planes.size(), 0.0);
  }
  double* pose(std::size_t i) { return &parameters_[pose_offset_ + kPoseSize * i]; }
  double* point(std::size_t i) { return &parameters_[point_offset_ + PointLandmark::kSize * i]; }
  double* line(std::size_t i) { return &parameters_[line_offset_ + LineLandmark::kSize * i]; }
  double* plane(std::size_t i) { return &parameters_[plane_offset_ + PlaneLandmark::kSize * i]; }

  void add_keyframe(std::size_t i, const egraph::Graph& graph, const BundleOptions& options) {
    const MapKeyframe& keyframe = map_.keyframe(window_.keyframes[i]);
    const Pose camera_from_world = keyframe.world_from_camera.inverse();
    write_pose(camera_from_world, pose(i));
    problem_.AddParameterBlock(pose(i), kPoseSize, &pose_manifold_);
    ordering_->AddElementToGroup(pose(i), 1);
    problem_.AddResidualBlock(
        new PosePriorCost(known_within(camera_from_world, options.rotation_sigma, options.translation_sigma)), nullptr,
        pose(i));
    std::vector<egraph::Association> living = keyframe.directions;
    std::erase_if(living, [&](const auto& seen) { return graph.find_landmark(seen.landmark) == nullptr; });
    for (DirectionFactor& factor : direction_factors(keyframe.features, graph, living, camera_from_world.rotation)) {
      problem_.AddResidualBlock(new DirectionCost(std::move(factor)), &direction_loss_, pose(i));
    }
  }

  void add_points() {
    for (std::size_t i = 0; i < window_.points.size(); ++i) {
      const MapPoint& in_map = map_.point(window_.points[i]);
      Eigen::Map<Eigen::Vector3d>{point(i)} = in_map.position;
      add_landmark<PointView>(
          point(i), map_.observers(in_map.id), point_loss_, [&](const MapKeyframe& keyframe, auto seen) {
            return PointView{
                observed_point(keyframe.features.points[seen], in_map.position, keyframe.world_from_camera.inverse(),
                               sharing_depth_error(keyframe.id)[seen]),
                &keyframe.features.camera};
          });
    }
  }

  void add_lines() {
    charts_.reserve(window_.lines.size());
    for (std::size_t i = 0; i < window_.lines.size(); ++i) {
      const MapLine& in_map = map_.line(window_.lines[i]);
      const LineChart* chart = &charts_.emplace_back(in_map.start, in_map.end);
      add_landmark<LineView>(line(i), map_.observers(in_map.id), line_loss_,
                             [&](const MapKeyframe& keyframe, auto seen) {
                               const geometry::CameraModel& camera = keyframe.features.camera;
                               return LineView{observed_line(keyframe.features.lines[seen], in_map.start, in_map.end,
                                                             camera, keyframe.world_from_camera.inverse()),
                                               chart, &camera};
                             });
    }
  }

  void add_planes() {
    for (std::size_t i = 0; i < window_.planes.size(); ++i) {
      PlaneLandmark::write(map_.plane(window_.planes[i]).estimate.plane, plane(i));
      problem_.AddParameterBlock(plane(i), PlaneLandmark::kSize, &plane_manifold_);
      add_landmark<PlaneView>(plane(i), map_.observers(window_.planes[i]), plane_loss_,
                              [](const MapKeyframe& keyframe, auto seen) {
                                return PlaneView{observed_plane(keyframe.features.planes[seen])};
                              });
    }
  }

  /// One residual per keyframe of the window, and one for all others together.
  template <typename View, typename MakeView>
  void add_landmark(double* landmark, std::span<const Observer> observers, ceres::LossFunction& loss,
                    const MakeView& view_of) {
    using Held = HeldCost<typename View::Landmark>;
    typename Held::Matrix information = Held::Matrix::Zero();
    typename Held::Tangent gradient = Held::Tangent::Zero();
    for (const Observer& observer : observers) {
      const MapKeyframe& keyframe = map_.keyframe(observer.keyframe);
      const View view = view_of(keyframe, static_cast<std::size_t>(observer.feature));
      const auto free = std::lower_bound(window_.keyframes.begin(), window_.keyframes.end(), observer.keyframe);
      if (free != window_.keyframes.end() && *free == observer.keyframe) {
        const auto index = static_cast<std::size_t>(free - window_.keyframes.begin());
        problem_.AddResidualBlock(new ViewCost<View>(view), &loss, pose(index), landmark);
        continue;
      }
      const auto at = view.residual(keyframe.world_from_camera.inverse(), landmark);
      std::array<double, 3> cost_and_derivatives{};
      loss.Evaluate(at.value.squaredNorm(), cost_and_derivatives.data());
      const double weight = cost_and_derivatives[1];
      information += weight * at.by_landmark.transpose() * at.by_landmark;
      gradient += weight * at.by_landmark.transpose() * at.value;
    }
    if (information.trace() > 0.0) {
      problem_.AddResidualBlock(new Held(landmark, information, gradient), nullptr, landmark);
    }
    ordering_->AddElementToGroup(landmark, 0);
  }

  const std::vector<int>& sharing_depth_error(KeyframeId id) {
    std::vector<int>& sharing = sharing_depth_error_[id];
    if (sharing.empty()) sharing = points_in_same_patch(map_.keyframe(id).features);
    return sharing;
  }

  void read_solution(BundleSolution& solution) {
    for (std::size_t i = 0; i < window_.keyframes.size(); ++i) {
      Pose camera_from_world = read_pose(pose(i));
      camera_from_world.rotation = geometry::nearest_rotation(camera_from_world.rotation);
      solution.world_from_camera.emplace_back(window_.keyframes[i], camera_from_world.inverse());
    }
    for (std::size_t i = 0; i < window_.points.size(); ++i) {
      solution.points.emplace_back(window_.points[i], Eigen::Map<const Eigen::Vector3d>(point(i)));
    }
    for (std::size_t i = 0; i < window_.lines.size(); ++i) {
      const Eigen::Map<const Eigen::Vector4d> offsets(line(i));
      solution.lines.push_back({window_.lines[i], {charts_[i].start_at(offsets), charts_[i].end_at(offsets)}});
    }
    for (std::size_t i = 0; i < window_.planes.size(); ++i) {
      solution.planes.emplace_back(window_.planes[i], PlaneLandmark::read(plane(i)));
    }
  }

  const Map& map_;
  const LocalWindow& window_;
  std::vector<double> parameters_;
  std::size_t pose_offset_ = 0;
  std::size_t point_offset_ = 0;
  std::size_t line_offset_ = 0;
  std::size_t plane_offset_ = 0;
  std::vector<LineChart> charts_;
  std::map<KeyframeId, std::vector<int>> sharing_depth_error_;  ///< per point of the keyframe
  PoseManifold pose_manifold_;
  PlaneManifold plane_manifold_;
  ceres::CauchyLoss point_loss_{std::sqrt(kChi2Three)};
  ceres::HuberLoss line_loss_{std::sqrt(kChi2Four)};
  ceres::HuberLoss plane_loss_{std::sqrt(kChi2Three)};
  ceres::HuberLoss direction_loss_{std::sqrt(kChi2Two)};
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_ = std::make_shared<ceres::ParameterBlockOrdering>();
  ceres::Problem problem_;  // last: it refers to what is above
};

}  // namespace

BundleSolution adjust_bundle(const Map& map, const egraph::Graph& graph, const LocalWindow& window,
                             const BundleOptions& options) {
  if (window.keyframes.empty()) return {};
  return BundleProblem(map, graph, window, options).solve(options);
}

void apply(const BundleSolution& solution, Map& map) {
  for (const auto& [id, pose] : solution.world_from_camera) map.move_keyframe_and_what_it_alone_saw(id, pose);
  for (const auto& [id, position] : solution.points) map.move_point(id, position);
  for (const auto& [id, ends] : solution.lines) map.move_line(id, ends[0], ends[1]);
  for (const auto& [id, plane] : solution.planes) map.move_plane(id, plane);
}

}  // namespace eg::tracking
