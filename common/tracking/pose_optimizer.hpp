#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/egraph/types.hpp"
#include "common/geometry/camera_model.hpp"
#include "common/geometry/pose.hpp"

namespace eg::tracking {

/// Points nearer than this (metres) have no usable projection.
inline constexpr double kNearestProjection = 0.05;

using egraph::Matrix6d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A map point seen in the frame: e^P of the paper, and the difference of depths where there is depth.
struct PointFactor {
  Eigen::Vector3d point_in_world;
  Eigen::Vector2d pixel;
  double pixel_sigma = 1.0;  ///< pixels; the map's uncertainty included
  double depth = 0.0;        ///< metres; 0: none
  double depth_sigma = 1.0;  ///< metres; the map's uncertainty included
};

/// A map segment seen in the frame: e^L, the distances of its projected end points from the observed image line.
struct LineFactor {
  Eigen::Vector3d start_in_world;
  Eigen::Vector3d end_in_world;
  Eigen::Vector3d image_line;  ///< a u + b v + c = 0 in pixels, a² + b² = 1
  /// Of the distances (pixels) of the projected start and end from that line.
  Eigen::Matrix2d whitener = Eigen::Matrix2d::Identity();
};

/// A map plane seen in the frame: e^pi, the height of the observed region's centroid above the map's plane. The
/// region's orientation is a DirectionFactor of its own; at the centroid the two errors are uncorrelated.
struct PlaneFactor {
  geometry::Plane plane_in_world;
  Eigen::Vector3d centroid_in_camera;
  double sigma = 1.0;  ///< metres
};

/// A scene direction of the E-Graph seen in the frame: together they are the rotation prior of the E-Graph.
struct DirectionFactor {
  Eigen::Vector3d direction_in_world;
  Eigen::Vector3d direction_in_camera;                   ///< sign unified
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< rad², tangential, camera frame; the landmark's included
};

/// Where the camera is expected before a frame is looked at.
struct MotionPrior {
  geometry::Pose camera_from_world;
  Matrix6d covariance = Matrix6d::Identity();  ///< of (rotation, translation), left perturbation; rad, m

  [[nodiscard]] double rotation_sigma() const;     ///< radians, about the worst axis
  [[nodiscard]] double translation_sigma() const;  ///< metres, along the worst
  /// W such that W δ has unit covariance; its upper rows do not depend on the translation.
  [[nodiscard]] Matrix6d whitener() const;
};

/// A place that is known equally well in all directions; radians and metres.
MotionPrior known_within(const geometry::Pose& camera_from_world, double rotation_sigma, double translation_sigma);

struct PoseProblem {
  geometry::CameraModel camera;
  std::vector<PointFactor> points;
  std::vector<LineFactor> lines;
  std::vector<PlaneFactor> planes;
  std::vector<DirectionFactor> directions;
  MotionPrior prior;
};

enum class FreeParameters { translation, pose };

struct PoseOptimizerOptions {
  int iterations = 10;  ///< per round
  int rounds = 3;       ///< after each, what fits beyond the gates is left out of the next
};

struct PoseSolution {
  geometry::Pose camera_from_world;
  /// Information of the measurements without the prior, of (rotation, translation), left perturbation of
  /// camera_from_world: T = exp(δ) T. Rotation is zero when only the translation was free.
  Matrix6d information = Matrix6d::Zero();
  std::vector<bool> point_inliers;
  std::vector<bool> depth_inliers;  ///< at its outline a thing's pixel often has the depth of what is behind
  std::vector<bool> line_inliers;
  std::vector<bool> plane_inliers;
  std::vector<bool> direction_inliers;

  [[nodiscard]] int inlier_points() const;
  [[nodiscard]] int inlier_lines() const;
  [[nodiscard]] int inlier_planes() const;
};

/// Levenberg-Marquardt over the pose of one frame (paper, section 5, "Translation estimation", and the frame-to-map
/// refinement), with the covariance of every measurement and robust losses: Cauchy's for points and the prior, Huber's
/// for lines, planes and directions.
PoseSolution optimize_pose(const PoseProblem& problem, const geometry::Pose& initial_camera_from_world,
                           FreeParameters free, const PoseOptimizerOptions& options = {});

/// The pose that the measurements of a solution have without the directions among them, and their information.
PoseSolution without_directions(const PoseProblem& problem, const PoseSolution& solution);

/// T ← exp(δ) T for δ = (rotation, translation): the perturbation that all Jacobians here refer to.
geometry::Pose perturb(const geometry::Pose& camera_from_world, const Vector6d& delta);

/// The δ that leads from one pose to the other: its translation is the way of the camera's centre, in the camera frame.
Vector6d pose_difference(const geometry::Pose& from, const geometry::Pose& to);

// Residuals in units of their standard deviations and Jacobians with respect to δ. Public for the numeric checks.
struct PointResidual {
  Eigen::Vector2d pixel;
  double depth = 0.0;
  Eigen::Matrix<double, 2, 6> pixel_jacobian;
  Eigen::Matrix<double, 1, 6> depth_jacobian;
  bool in_front = false;
};
PointResidual point_residual(const PointFactor& factor, const geometry::CameraModel& camera,
                             const geometry::Pose& pose);

/// The squared reprojection error in units of its variance; infinite behind the camera.
double reprojection_chi2(const PointFactor& factor, const geometry::CameraModel& camera, const geometry::Pose& pose);

struct LineResidual {
  Eigen::Vector2d distances;
  Eigen::Matrix<double, 2, 6> jacobian;
  bool in_front = false;
};
LineResidual line_residual(const LineFactor& factor, const geometry::CameraModel& camera, const geometry::Pose& pose);

struct PlaneResidual {
  double height = 0.0;
  Eigen::Matrix<double, 1, 6> jacobian;
};
PlaneResidual plane_residual(const PlaneFactor& factor, const geometry::Pose& pose);

struct DirectionResidual {
  Eigen::Vector2d angle;
  Eigen::Matrix<double, 2, 6> jacobian;
};
DirectionResidual direction_residual(const DirectionFactor& factor, const geometry::Pose& pose);

}  // namespace eg::tracking
