#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "common/features/line_segment.hpp"
#include "common/geometry/camera_model.hpp"

namespace eg::features {

struct LineLifterOptions {
  int min_inliers = 10;                  ///< depth samples on the line
  double min_inlier_ratio = 0.4;         ///< of all samples along the segment, with or without depth
  double min_coverage = 0.5;             ///< of the segment's length between its first and last inlier
  double inlier_sigmas = 3.0;            ///< a sample's largest residual, in standard deviations of the sensor
  int max_iterations = 50;               ///< of RANSAC
  double max_relative_sigma = 0.1;       ///< of an end point's depth
  double end_slide_sigma = 1.5;          ///< pixels: end points of segments slide along their line
  double direction_sigma_floor = 0.004;  ///< radians in the interpretation plane: the sensor's systematic errors
};

/// A segment in space, in the camera frame.
struct LiftedLine {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< metres, on the rays of the segment's end points
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  Eigen::Matrix3d start_covariance = Eigen::Matrix3d::Zero();  ///< m²
  Eigen::Matrix3d end_covariance = Eigen::Matrix3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit, from start to end
  double direction_sigma = 0.0;  ///< radians, in the plane of the camera and the line; across it the pixels decide
};

/// Lifts a segment into space with the depth image (CV_32FC1, metres). A line in space projects to inverse depths that
/// are linear along its image, 1/z = a + b t, with the noise of inverse depth known from the sensor's: so the weighted
/// linear fit is the maximum likelihood one. RANSAC (Fischler and Bolles 1981) finds the samples that agree; samples
/// beside the segment bring a third unknown, the surface's slope across it. Covariance: the fit's, scaled by the
/// observed scatter and the correlation of neighbouring residuals, and the segment's pixel noise. None if too little
/// depth agrees. `seed` makes the samples; nothing else is random.
std::optional<LiftedLine> lift_line(const Segment& segment, const cv::Mat& depth, const geometry::CameraModel& camera,
                                    const LineLifterOptions& options, std::uint64_t seed);

}  // namespace eg::features
