#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace eg::features {

/// A straight edge in the image. Its direction from start to end has the brighter side on its right, (-u.y, u.x) of the
/// unit vector u, once it is refined.
struct Segment {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();  ///< pixels
  Eigen::Vector2d end = Eigen::Vector2d::Zero();
  double sigma = 0.5;  ///< standard deviation of each end point across the segment, pixels

  [[nodiscard]] double length() const { return (end - start).norm(); }
  [[nodiscard]] Eigen::Vector2d unit() const { return (end - start).normalized(); }
  /// Unit vector across the segment, to its right in the image (y down).
  [[nodiscard]] Eigen::Vector2d normal() const { return {-unit().y(), unit().x()}; }
  [[nodiscard]] Eigen::Vector2d at(double fraction) const { return start + fraction * (end - start); }
};

}  // namespace eg::features
