#pragma once

#include <ceres/cost_function.h>
#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Cholesky>

#include "common/geometry/so3.hpp"
#include "common/tracking/bundle_residuals.hpp"

/// The residuals of bundle_residuals.hpp as Ceres wants them. For bundle_adjustment.cpp only: Ceres' headers are heavy.
namespace eg::tracking {

/// Numbers of a pose: rotation by columns, translation.
inline constexpr int kPoseSize = 12;

inline geometry::Pose read_pose(const double* x) {
  return {Eigen::Map<const Eigen::Matrix3d>(x), Eigen::Map<const Eigen::Vector3d>(x + 9)};
}
inline void write_pose(const geometry::Pose& pose, double* x) {
  Eigen::Map<Eigen::Matrix3d>{x} = pose.rotation;
  Eigen::Map<Eigen::Vector3d>{x + 9} = pose.translation;
}

/// A manifold whose cost functions give their derivatives in its tangent space already: the first Tangent columns of a
/// Jacobian hold them, and the derivative of Plus picks these.
template <int Ambient, int Tangent>
class TangentManifold : public ceres::Manifold {
 public:
  [[nodiscard]] int AmbientSize() const override { return Ambient; }
  [[nodiscard]] int TangentSize() const override { return Tangent; }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, Ambient, Tangent, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, Tangent, Ambient, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
};

/// camera_from_world under T = exp(δ) T.
class PoseManifold : public TangentManifold<kPoseSize, 6> {
 public:
  bool Plus(const double* x, const double* delta, double* sum) const override {
    write_pose(perturb(read_pose(x), Eigen::Map<const Vector6d>(delta)), sum);
    return true;
  }
  bool Minus(const double* y, const double* x, double* difference) const override {
    Eigen::Map<Vector6d>{difference} = pose_difference(read_pose(x), read_pose(y));
    return true;
  }
};

/// A map point as a landmark of the adjustment: its position.
struct PointLandmark {
  static constexpr int kSize = 3;
  static constexpr int kTangent = 3;
  using Tangent = Eigen::Vector3d;

  static Tangent difference(const double* from, const double* to) {
    return Eigen::Map<const Eigen::Vector3d>(to) - Eigen::Map<const Eigen::Vector3d>(from);
  }
  static Eigen::Matrix3d difference_by_tangent(const double* /*from*/, const double* /*to*/) {
    return Eigen::Matrix3d::Identity();
  }
};

/// A map line: the offsets of its chart.
struct LineLandmark {
  static constexpr int kSize = 4;
  static constexpr int kTangent = 4;
  using Tangent = Eigen::Vector4d;

  static Tangent difference(const double* from, const double* to) {
    return Eigen::Map<const Eigen::Vector4d>(to) - Eigen::Map<const Eigen::Vector4d>(from);
  }
  static Eigen::Matrix4d difference_by_tangent(const double* /*from*/, const double* /*to*/) {
    return Eigen::Matrix4d::Identity();
  }
};

/// A map plane: normal and distance, with three degrees of freedom.
struct PlaneLandmark {
  static constexpr int kSize = 4;
  static constexpr int kTangent = 3;
  using Tangent = Eigen::Vector3d;

  static geometry::Plane read(const double* x) { return {Eigen::Map<const Eigen::Vector3d>(x), x[3]}; }
  static void write(const geometry::Plane& plane, double* x) {
    Eigen::Map<Eigen::Vector3d>{x} = plane.normal;
    x[3] = plane.distance;
  }
  static Tangent difference(const double* from, const double* to) { return plane_difference(read(from), read(to)); }
  /// The tangent bases at both ends may differ.
  static Eigen::Matrix3d difference_by_tangent(const double* from, const double* to) {
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
    jacobian.topLeftCorner<2, 2>() =
        geometry::tangent_basis(read(from).normal).transpose() * geometry::tangent_basis(read(to).normal);
    return jacobian;
  }
};

class PlaneManifold : public TangentManifold<PlaneLandmark::kSize, PlaneLandmark::kTangent> {
 public:
  bool Plus(const double* x, const double* delta, double* sum) const override {
    PlaneLandmark::write(move_plane(PlaneLandmark::read(x), Eigen::Map<const Eigen::Vector3d>(delta)), sum);
    return true;
  }
  bool Minus(const double* y, const double* x, double* difference) const override {
    Eigen::Map<Eigen::Vector3d>{difference} = PlaneLandmark::difference(x, y);
    return true;
  }
};

/// Writes a Jacobian of `Columns` columns of which the tangent space fills the first.
template <int Columns, int N, int Tangent>
void write_jacobian(const Eigen::Matrix<double, N, Tangent>& in_tangent_space, double* jacobian) {
  Eigen::Map<Eigen::Matrix<double, N, Columns, Eigen::RowMajor>> all(jacobian);
  all.template leftCols<Tangent>() = in_tangent_space;
  if constexpr (Columns > Tangent) all.template rightCols<Columns - Tangent>().setZero();
}

/// What one keyframe sees of one landmark. `View` gives the BundleResidual from a pose and the landmark's numbers.
template <typename View>
class ViewCost : public ceres::SizedCostFunction<View::kResiduals, kPoseSize, View::Landmark::kSize> {
 public:
  explicit ViewCost(View view) : view_(std::move(view)) {}

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const auto at = view_.residual(read_pose(x[0]), x[1]);
    Eigen::Map<Eigen::Matrix<double, View::kResiduals, 1>>{residuals} = at.value;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) write_jacobian<kPoseSize>(at.by_pose, jacobians[0]);
    if (jacobians[1] != nullptr) write_jacobian<View::Landmark::kSize>(at.by_landmark, jacobians[1]);
    return true;
  }

 private:
  View view_;
};

/// What keyframes that do not move see of one landmark, as one quadratic cost about the landmark's present value.
template <typename Landmark>
class HeldCost : public ceres::SizedCostFunction<Landmark::kTangent, Landmark::kSize> {
 public:
  using Tangent = typename Landmark::Tangent;
  using Matrix = Eigen::Matrix<double, Landmark::kTangent, Landmark::kTangent>;

  /// The cost δᵀ information δ / 2 + gradientᵀ δ of a step δ from `present`, but for a constant.
  HeldCost(const double* present, const Matrix& information, const Tangent& gradient) {
    std::copy_n(present, Landmark::kSize, present_.begin());
    // What those keyframes leave open (the depth of a point without one) is held by next to nothing.
    const Eigen::LLT<Matrix> factor(information + 1e-9 * information.trace() * Matrix::Identity());
    root_ = factor.matrixU();
    offset_ = factor.matrixL().solve(gradient);
  }

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    Eigen::Map<Tangent>{residuals} = root_ * Landmark::difference(present_.data(), x[0]) + offset_;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      const Matrix jacobian = root_ * Landmark::difference_by_tangent(present_.data(), x[0]);
      write_jacobian<Landmark::kSize>(jacobian, jacobians[0]);
    }
    return true;
  }

 private:
  std::array<double, Landmark::kSize> present_{};
  Matrix root_;
  Tangent offset_;
};

/// A scene direction of the E-Graph seen by a keyframe.
class DirectionCost : public ceres::SizedCostFunction<2, kPoseSize> {
 public:
  explicit DirectionCost(DirectionFactor factor) : factor_(std::move(factor)) {}

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const DirectionResidual at = direction_residual(factor_, read_pose(x[0]));
    Eigen::Map<Eigen::Vector2d>{residuals} = at.angle;
    if (jacobians != nullptr && jacobians[0] != nullptr) write_jacobian<kPoseSize>(at.jacobian, jacobians[0]);
    return true;
  }

 private:
  DirectionFactor factor_;
};

/// Tracking put a keyframe where it is, give or take.
class PosePriorCost : public ceres::SizedCostFunction<6, kPoseSize> {
 public:
  explicit PosePriorCost(const MotionPrior& prior)
      : camera_from_world_(prior.camera_from_world), whitener_(prior.whitener()) {}

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    Eigen::Map<Vector6d>{residuals} = whitener_ * pose_difference(camera_from_world_, read_pose(x[0]));
    if (jacobians != nullptr && jacobians[0] != nullptr) write_jacobian<kPoseSize>(whitener_, jacobians[0]);
    return true;
  }

 private:
  geometry::Pose camera_from_world_;
  Matrix6d whitener_;
};

}  // namespace eg::tracking
