#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/tracking/pose_optimizer.hpp"

namespace eg::tracking {

struct TranslationOptions {
  int samples = 64;           ///< couples of correspondences that are tried
  double inlier_chi2 = 9.21;  ///< 99 % quantile of chi²(2)
  int min_inliers = 4;        ///< two that agree with the two of the sample
  std::uint64_t seed = 1;
};

struct TranslationEstimate {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< of camera_from_world
  std::vector<bool> inliers;
  int inlier_count = 0;
};

/// The translation of camera_from_world for a known rotation, from two point correspondences (paper, section 3.1:
/// equation 1 with R known is linear in t; a pixel gives two equations, a depth one more). Least squares over the given
/// factors; nothing if they do not determine it.
std::optional<Eigen::Vector3d> solve_translation(std::span<const PointFactor> factors,
                                                 const geometry::CameraModel& camera,
                                                 const Eigen::Matrix3d& camera_from_world_rotation);

/// RANSAC over couples of correspondences. Nothing if fewer than min_inliers agree.
std::optional<TranslationEstimate> estimate_translation(std::span<const PointFactor> factors,
                                                        const geometry::CameraModel& camera,
                                                        const Eigen::Matrix3d& camera_from_world_rotation,
                                                        const TranslationOptions& options = {});

}  // namespace eg::tracking
