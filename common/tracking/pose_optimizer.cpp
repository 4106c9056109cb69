#include "common/tracking/pose_optimizer.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "common/geometry/so3.hpp"
#include "common/tracking/robust_loss.hpp"

namespace eg::tracking {
namespace {

struct NormalEquations {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double cost = 0.0;

  /// Adds a whitened residual under a robust loss of its chi².
  template <int N>
  void add(const Eigen::Matrix<double, N, 1>& residual, const Eigen::Matrix<double, N, 6>& jacobian,
           const RobustLoss& loss) {
    hessian.noalias() += loss.weight * jacobian.transpose() * jacobian;
    gradient.noalias() += loss.weight * jacobian.transpose() * residual;
    cost += loss.cost;
  }
};

Eigen::Matrix<double, 1, 1> scalar(double value) { return Eigen::Matrix<double, 1, 1>(value); }

NormalEquations linearize_measurements(const PoseProblem& problem, const geometry::Pose& pose,
                                       const PoseSolution& inliers) {
  NormalEquations equations;
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    if (!inliers.point_inliers[i]) continue;
    const PointResidual at = point_residual(problem.points[i], problem.camera, pose);
    if (!at.in_front) continue;
    equations.add<2>(at.pixel, at.pixel_jacobian, cauchy(at.pixel.squaredNorm(), kChi2Two));
    if (problem.points[i].depth > 0.0 && inliers.depth_inliers[i])
      equations.add<1>(scalar(at.depth), at.depth_jacobian, cauchy(at.depth * at.depth, kChi2One));
  }
  for (std::size_t i = 0; i < problem.lines.size(); ++i) {
    if (!inliers.line_inliers[i]) continue;
    const LineResidual at = line_residual(problem.lines[i], problem.camera, pose);
    if (at.in_front) equations.add<2>(at.distances, at.jacobian, huber(at.distances.squaredNorm(), kChi2Two));
  }
  for (std::size_t i = 0; i < problem.planes.size(); ++i) {
    if (!inliers.plane_inliers[i]) continue;
    const PlaneResidual at = plane_residual(problem.planes[i], pose);
    equations.add<1>(scalar(at.height), at.jacobian, huber(at.height * at.height, kChi2One));
  }
  for (std::size_t i = 0; i < problem.directions.size(); ++i) {
    if (!inliers.direction_inliers[i]) continue;
    const DirectionResidual at = direction_residual(problem.directions[i], pose);
    equations.add<2>(at.angle, at.jacobian, huber(at.angle.squaredNorm(), kChi2Two));
  }
  return equations;
}

/// A hand may jerk: a prediction that the measurements contradict must not drag them along.
void add_prior(const MotionPrior& prior, const geometry::Pose& pose, NormalEquations& equations) {
  const Matrix6d whitener = prior.whitener();
  const Vector6d residual = whitener * pose_difference(prior.camera_from_world, pose);
  const Eigen::Vector3d turn = residual.head<3>();
  const Eigen::Vector3d way = residual.tail<3>();
  equations.add<3>(turn, whitener.topRows<3>(), cauchy(turn.squaredNorm(), kChi2Three));
  equations.add<3>(way, whitener.bottomRows<3>(), cauchy(way.squaredNorm(), kChi2Three));
}

NormalEquations linearize(const PoseProblem& problem, const geometry::Pose& pose, const PoseSolution& inliers) {
  NormalEquations equations = linearize_measurements(problem, pose, inliers);
  add_prior(problem.prior, pose, equations);
  return equations;
}

Vector6d damped_step(const NormalEquations& equations, double damping, FreeParameters free) {
  Matrix6d damped = equations.hessian;
  damped.diagonal() *= 1.0 + damping;
  Vector6d step = Vector6d::Zero();
  if (free == FreeParameters::translation) {
    step.tail<3>() = -damped.bottomRightCorner<3, 3>().ldlt().solve(equations.gradient.tail<3>());
  } else {
    step = -damped.ldlt().solve(equations.gradient);
  }
  return step;
}

/// Levenberg-Marquardt with the damping schedule of Marquardt (1963).
geometry::Pose descend(const PoseProblem& problem, geometry::Pose pose, FreeParameters free, int iterations,
                       const PoseSolution& inliers) {
  double damping = 1e-4;
  NormalEquations equations = linearize(problem, pose, inliers);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const Vector6d step = damped_step(equations, damping, free);
    if (!step.allFinite()) break;
    const geometry::Pose candidate = perturb(pose, step);
    const NormalEquations at_candidate = linearize(problem, candidate, inliers);
    if (at_candidate.cost < equations.cost) {
      const bool converged = equations.cost - at_candidate.cost < 1e-6 * equations.cost;
      pose = candidate;
      equations = at_candidate;
      damping = std::max(1e-9, damping / 10.0);
      if (converged) break;
    } else {
      damping *= 10.0;
      if (damping > 1e6) break;
    }
  }
  return pose;
}

void classify(const PoseProblem& problem, const geometry::Pose& pose, PoseSolution& solution) {
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    solution.point_inliers[i] = reprojection_chi2(problem.points[i], problem.camera, pose) < kChi2Two;
    const double depth = point_residual(problem.points[i], problem.camera, pose).depth;
    solution.depth_inliers[i] = depth * depth < kChi2One;
  }
  for (std::size_t i = 0; i < problem.lines.size(); ++i) {
    const LineResidual at = line_residual(problem.lines[i], problem.camera, pose);
    solution.line_inliers[i] = at.in_front && at.distances.squaredNorm() < kChi2Two;
  }
  for (std::size_t i = 0; i < problem.planes.size(); ++i) {
    // Three standard deviations: there are few planes, and a good one must not be lost to ordinary noise.
    solution.plane_inliers[i] = std::abs(plane_residual(problem.planes[i], pose).height) < 3.0;
  }
  for (std::size_t i = 0; i < problem.directions.size(); ++i) {
    solution.direction_inliers[i] = direction_residual(problem.directions[i], pose).angle.squaredNorm() < 13.82;
  }
}

double worst_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues()[2]);
}

int count(const std::vector<bool>& flags) { return static_cast<int>(std::count(flags.begin(), flags.end(), true)); }

}  // namespace

double MotionPrior::rotation_sigma() const { return worst_sigma(covariance.topLeftCorner<3, 3>()); }
double MotionPrior::translation_sigma() const { return worst_sigma(covariance.bottomRightCorner<3, 3>()); }

Matrix6d MotionPrior::whitener() const { return covariance.llt().matrixL().solve(Matrix6d::Identity()); }

MotionPrior known_within(const geometry::Pose& camera_from_world, double rotation_sigma, double translation_sigma) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(rotation_sigma * rotation_sigma),
      Eigen::Vector3d::Constant(translation_sigma * translation_sigma);
  return {camera_from_world, variances.asDiagonal()};
}

int PoseSolution::inlier_points() const { return count(point_inliers); }
int PoseSolution::inlier_lines() const { return count(line_inliers); }
int PoseSolution::inlier_planes() const { return count(plane_inliers); }

PoseSolution optimize_pose(const PoseProblem& problem, const geometry::Pose& initial_camera_from_world,
                           FreeParameters free, const PoseOptimizerOptions& options) {
  PoseSolution solution;
  solution.camera_from_world = initial_camera_from_world;
  solution.point_inliers.assign(problem.points.size(), true);
  solution.depth_inliers.assign(problem.points.size(), true);
  solution.line_inliers.assign(problem.lines.size(), true);
  solution.plane_inliers.assign(problem.planes.size(), true);
  solution.direction_inliers.assign(problem.directions.size(), true);
  for (int round = 0; round < options.rounds; ++round) {
    solution.camera_from_world = descend(problem, solution.camera_from_world, free, options.iterations, solution);
    classify(problem, solution.camera_from_world, solution);
  }
  solution.information = linearize_measurements(problem, solution.camera_from_world, solution).hessian;
  if (free == FreeParameters::translation) {
    solution.information.topRows<3>().setZero();
    solution.information.leftCols<3>().setZero();
  }
  solution.camera_from_world.rotation = geometry::nearest_rotation(solution.camera_from_world.rotation);
  return solution;
}

PoseSolution without_directions(const PoseProblem& problem, const PoseSolution& solution) {
  constexpr int kSteps = 2;  // from so near, each step squares what is left of the way
  PoseSolution without = solution;
  without.direction_inliers.assign(problem.directions.size(), false);
  without.camera_from_world = descend(problem, solution.camera_from_world, FreeParameters::pose, kSteps, without);
  without.information = linearize_measurements(problem, without.camera_from_world, without).hessian;
  without.camera_from_world.rotation = geometry::nearest_rotation(without.camera_from_world.rotation);
  return without;
}

}  // namespace eg::tracking
