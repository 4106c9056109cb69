#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/features/line_extractor.hpp"
#include "common/features/vanishing_preferences.hpp"
#include "common/geometry/camera_model.hpp"

namespace eg::features {

/// Radians: edges of real things are not straighter than that.
inline constexpr double kStraightness = 0.0007;

/// What one line says about the direction v it runs in, as two independent measurements: v lies in the plane of the
/// camera and the line, normal · v = 0 (pixels), and, if the line has depth, sideways · v = 0 within that plane.
struct DirectionEvidence {
  DirectionalSegment segment;
  double pixel_sigma = 0.0;                         ///< of the segment's end points, across it
  double length = 0.0;                              ///< pixels
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< change of the normal when the segment shifts across, per pixel
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();   ///< and when its ends move apart across, per pixel of either end
  bool has_depth = false;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< of the line in space
  Eigen::Vector3d sideways = Eigen::Vector3d::Zero();   ///< unit: normal × direction
  double sideways_sigma = 0.0;                          ///< radians

  /// Standard deviation of normal · v, for a v near the plane.
  [[nodiscard]] double normal_sigma(const Eigen::Vector3d& v) const;
};

DirectionEvidence make_evidence(const MeasuredLine& line, const geometry::CameraModel& camera);

/// A direction with its covariance.
struct DirectionEstimate {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< rad², tangential

  /// The greatest standard deviation of any axis, radians.
  [[nodiscard]] double max_sigma() const;
};

/// The direction that agrees best with the evidence: weighted least squares on the unit sphere (the eigenvector of the
/// smallest eigenvalue of the sum of weighted outer products), reweighted because the noise of a normal depends on
/// where the vanishing point is, and because stray lines are to count little (Cauchy). This fuses the vanishing point
/// of the segments with the directions of the lines in space, each by its own covariance. The covariance is scaled by
/// the observed scatter where that is larger. None if the evidence leaves an axis undetermined.
std::optional<DirectionEstimate> fit_direction(const std::vector<const DirectionEvidence*>& evidence,
                                               const Eigen::Vector3d& initial);

}  // namespace eg::features
