#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "common/features/line_depth_samples.hpp"
#include "common/features/line_lifter.hpp"

namespace eg::features {

/// 1/z = at_middle + slope · along, on the segment.
struct InverseDepthLine {
  double at_middle = 0.0;                                ///< 1/m
  double slope = 0.0;                                    ///< 1/m per half length
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of (at_middle, slope)

  [[nodiscard]] double at(double along) const { return at_middle + slope * along; }
};

/// The robust weighted fit behind lift_line.
std::optional<InverseDepthLine> fit_inverse_depth(const LineDepthSamples& samples, const LineLifterOptions& options,
                                                  std::uint64_t seed);

}  // namespace eg::features
