#pragma once

#include <Eigen/Core>
#include <iosfwd>
#include <string>
#include <vector>

#include "common/features/features.hpp"

namespace eg::features_eval {

/// Errors of measured directions of one kind.
struct DirectionErrors {
  std::vector<double> angles_deg;        ///< between the measured and the true direction
  std::vector<double> squared_by_sigma;  ///< normalised squared errors per degree of freedom; expectation 1

  /// `found` and `truth` are unit vectors whose signs mean nothing; `covariance` (rad², tangential) is that of their
  /// difference.
  void add(const Eigen::Vector3d& found, const Eigen::Vector3d& truth, const Eigen::Matrix3d& covariance);
};

/// Something counted out of something: "31 of 32".
struct Share {
  int part = 0;
  int whole = 0;

  void add(bool counts) {
    part += counts ? 1 : 0;
    whole += 1;
  }
  [[nodiscard]] double percent() const { return whole > 0 ? 100.0 * part / whole : 0.0; }
};

/// Median and 95th percentile of the angles, mean and median of the normalised squared errors.
std::string summary(const DirectionErrors& errors);

/// "97.3 % of 1204".
std::string summary(const Share& share);

/// The indices into `directions` of one kind.
std::vector<std::size_t> indices_of(const std::vector<features::DirectionFeature>& directions,
                                    features::DirectionKind kind);

}  // namespace eg::features_eval
