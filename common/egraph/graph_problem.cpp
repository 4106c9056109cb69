#include "common/egraph/graph_problem.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "common/egraph/graph_residuals.hpp"
#include "common/geometry/so3.hpp"

namespace eg::egraph {
namespace {

/// Cauchy's loss c² log(1 + s/c²) of a squared residual s, and its derivative: what contradicts everything else, such
/// as a wrong association, pulls less and less.
double robust_loss(double chi2, double scale) { return scale * std::log1p(chi2 / scale); }
double robust_weight(double chi2, double scale) { return 1.0 / (1.0 + chi2 / scale); }

/// What holds unknowns that nothing was measured of (rad⁻², m⁻²): next to nothing.
constexpr double kWeak = 1e-6;

/// Adds up J^T W J and J^T W r block by block.
class NormalEquations {
 public:
  explicit NormalEquations(int unknowns) : gradient_(Eigen::VectorXd::Zero(unknowns)) {}

  template <typename JacobianA, typename JacobianB, typename Information>
  void add_product(int row, const JacobianA& a, int column, const JacobianB& b, const Information& information) {
    if (row < 0 || column < 0) return;
    const auto block = (a.transpose() * information * b).eval();
    for (Eigen::Index i = 0; i < block.rows(); ++i) {
      for (Eigen::Index j = 0; j < block.cols(); ++j) add_entry(row + i, column + j, block(i, j), row == column);
    }
  }

  template <typename Jacobian, typename Information, typename Residual>
  void add_gradient(int row, const Jacobian& jacobian, const Information& information, const Residual& residual) {
    if (row >= 0) gradient_.segment(row, jacobian.cols()) += jacobian.transpose() * information * residual;
  }

  GraphProblem::Linearization take() {
    const auto size = gradient_.size();
    Eigen::SparseMatrix<double> hessian(size, size);
    hessian.setFromTriplets(entries_.begin(), entries_.end());
    return {std::move(hessian), std::move(gradient_)};
  }

 private:
  void add_entry(Eigen::Index row, Eigen::Index column, double value, bool diagonal_block) {
    if (diagonal_block && row < column) return;  // of a symmetric block, half
    entries_.emplace_back(static_cast<int>(std::max(row, column)), static_cast<int>(std::min(row, column)), value);
  }

  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd gradient_;
};

}  // namespace

double GraphProblem::cost() const {
  double sum = 0.0;
  for (const View& view : views) {
    const DirectionResidual at(keyframes[view.keyframe].world_from_camera.rotation, landmarks[view.landmark].direction,
                               view.in_camera, view.covariance, options_.min_direction_sigma);
    sum += robust_loss(at.chi2(), options_.direction_chi2);
  }
  for (const Constraint& constraint : constraints) {
    const RelativePoseResidual at(keyframes[constraint.first].world_from_camera,
                                  keyframes[constraint.second].world_from_camera, constraint.measured);
    sum += options_.refine == Refinement::poses ? robust_loss(at.chi2(), options_.pose_chi2)
                                                : robust_loss(at.rotation_chi2(), options_.rotation_chi2);
  }
  return 0.5 * sum;
}

GraphProblem::Linearization GraphProblem::linearize() const {
  NormalEquations equations(unknowns);
  for (const View& view : views) {
    const Keyframe& keyframe = keyframes[view.keyframe];
    const Landmark& landmark = landmarks[view.landmark];
    const DirectionResidual at(keyframe.world_from_camera.rotation, landmark.direction, view.in_camera, view.covariance,
                               options_.min_direction_sigma);
    const Eigen::Matrix2d weighted = robust_weight(at.chi2(), options_.direction_chi2) * at.information;
    equations.add_product(keyframe.column, at.by_rotation, keyframe.column, at.by_rotation, weighted);
    equations.add_product(keyframe.column, at.by_rotation, landmark.column, at.by_direction, weighted);
    equations.add_product(landmark.column, at.by_direction, landmark.column, at.by_direction, weighted);
    equations.add_gradient(keyframe.column, at.by_rotation, weighted, at.value);
    equations.add_gradient(landmark.column, at.by_direction, weighted, at.value);
  }
  const auto add = [&](int first, int second, const auto& by_first, const auto& by_second, const auto& weighted,
                       const auto& value) {
    equations.add_product(first, by_first, first, by_first, weighted);
    equations.add_product(first, by_first, second, by_second, weighted);
    equations.add_product(second, by_second, second, by_second, weighted);
    equations.add_gradient(first, by_first, weighted, value);
    equations.add_gradient(second, by_second, weighted, value);
  };
  for (const Constraint& constraint : constraints) {
    const Keyframe& first = keyframes[constraint.first];
    const Keyframe& second = keyframes[constraint.second];
    const RelativePoseResidual at(first.world_from_camera, second.world_from_camera, constraint.measured);
    if (options_.refine == Refinement::poses) {
      const Matrix6d weighted = robust_weight(at.chi2(), options_.pose_chi2) * at.information;
      add(first.column, second.column, at.by_first, at.by_second, weighted, at.value);
    } else {
      const Eigen::Matrix3d weighted =
          robust_weight(at.rotation_chi2(), options_.rotation_chi2) * at.rotation_information;
      add(first.column, second.column, at.by_first.topLeftCorner<3, 3>().eval(),
          at.by_second.topLeftCorner<3, 3>().eval(), weighted, at.value.head<3>().eval());
    }
  }
  return equations.take();
}

bool GraphProblem::step(const Linearization& linear, double damping) {
  Eigen::SparseMatrix<double> hessian = linear.hessian;
  for (int i = 0; i < unknowns; ++i) hessian.coeffRef(i, i) += damping * hessian.coeff(i, i) + kWeak;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factors(hessian);
  if (factors.info() != Eigen::Success) return false;
  const Eigen::VectorXd step = factors.solve(-linear.gradient);
  if (!step.allFinite()) return false;
  for (Keyframe& keyframe : keyframes) {
    if (keyframe.column < 0) continue;
    geometry::Pose& pose = keyframe.world_from_camera;
    pose.rotation = geometry::so3_exp(step.segment<3>(keyframe.column)) * pose.rotation;
    if (options_.refine == Refinement::poses) pose.translation += step.segment<3>(keyframe.column + 3);
  }
  for (Landmark& landmark : landmarks) {
    if (landmark.column < 0) continue;
    const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(landmark.direction);
    landmark.direction = (landmark.direction + basis * step.segment<2>(landmark.column)).normalized();
  }
  return true;
}

}  // namespace eg::egraph
