#pragma once

#include <cstdint>

#include "common/features/features.hpp"
#include "common/observations/recording.hpp"

namespace eg::observations {

/// How the sensor measured. The defaults are those of Open-Structure (Li et al., RA-L 2024), whose files state the
/// pixel noise and hold true values that the noise of the line depths can be taken from.
struct SensorModel {
  double pixel_sigma = 1.0;           ///< of points and of end points of lines, pixels per axis
  double line_depth_sigma = 0.05;     ///< of the measured depth of end points, metres
  bool depth_noise = true;            ///< points' depths with the noise of geometry::depth_sigma, or exact
  std::uint64_t seed = 1;             ///< of that noise
  double max_direction_sigma = 0.05;  ///< radians (3°): directions known less well are left out
};

/// A recorded frame as features with known track ids: points with depth, lines in space, and one vanishing direction
/// per group of parallel lines of which the frame sees two or more. Observations outside the camera's image are left
/// out. There are no descriptors: identity is known. The header holds the time only. The noise depends on the seed and
/// `index`, the frame's number in its recording, alone.
features::FrameFeatures features_of(const Recording& recording, std::size_t index, const geometry::CameraModel& camera,
                                    const SensorModel& sensor = {});

}  // namespace eg::observations
